// Gives the form's control its key: from the seller's name and passphrase, in this page.
import { createClient } from "/assets/meshmark/dist/client.js";
import "/assets/meshmark/dist/elements.js";

const protect = document.querySelector("meshmark-protect");
if (protect) {
  protect.key = async () => {
    const [seller, passphrase] = ["seller", "passphrase"].map((id) => document.getElementById(id).value);
    const client = await createClient();
    try {
      return await client.deriveKey(seller, passphrase);
    } finally {
      client.dispose();
    }
  };
}
