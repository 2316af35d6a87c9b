/** The package's client, started once with the page. */
import { createClient, type Client } from "meshmark/client";

export const engine: Promise<Client> = createClient();
