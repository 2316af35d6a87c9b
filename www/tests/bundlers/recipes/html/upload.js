import "/meshmark/dist/elements.js"; // node_modules/meshmark, served as /meshmark
import { keyOfThisUser } from "/key.js";

document.querySelector("meshmark-protect").ownerKey = keyOfThisUser;
