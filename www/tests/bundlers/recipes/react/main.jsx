import { createRoot } from "react-dom/client";
import { Upload } from "./upload.jsx";

createRoot(document.getElementById("root")).render(<Upload />);
