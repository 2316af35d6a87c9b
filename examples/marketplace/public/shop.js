// Gives the form's control its key: from the seller's name and passphrase, in this page.
import { createClient } from "/assets/meshmark/dist/client.js";
import "/assets/meshmark/dist/elements.js";

const protect = document.querySelector("meshmark-protect");
if (protect) {
  const fields = ["seller", "passphrase"].map((id) => document.getElementById(id));
  const words = () => fields.map((field) => field.value);
  let used = words();
  protect.ownerKey = async () => {
    used = words();
    const client = await createClient();
    try {
      return await client.deriveKey(...used);
    } finally {
      client.dispose();
    }
  };
  // Another name or passphrase is another key.
  for (const field of fields) {
    field.addEventListener("change", () => {
      if (words().some((word, i) => word !== used[i])) {
        protect.again();
      }
    });
  }
}
