/** Keeps the page's files for the next visit, with or without a network. */
import { find } from "./dom";

export async function startOffline(): Promise<void> {
  if (!import.meta.env.PROD || !("serviceWorker" in navigator)) {
    return;
  }
  await navigator.serviceWorker.register("./sw.js");
  await navigator.serviceWorker.ready;
  find("#offline").textContent = "Ready to work offline";
}
