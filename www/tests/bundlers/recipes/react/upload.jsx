import "meshmark/elements";
import { keyOfThisUser } from "../key.js";

export function Upload() {
  return (
    <form method="post" action="/upload" encType="multipart/form-data">
      <meshmark-protect name="model" tag="ADA-1" required ownerKey={keyOfThisUser} />
      <button>Upload</button>
    </form>
  );
}
