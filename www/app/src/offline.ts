/** Keeps the page's files for the next visit, with or without a network. */
import { find } from "./dom";

export async function startOffline(): Promise<void> {
  if (!import.meta.env.PROD || !("serviceWorker" in navigator)) {
    return;
  }
  const registration = await navigator.serviceWorker.register("./sw.js");
  await navigator.serviceWorker.ready;
  const tell = () => {
    find("#offline").textContent = registration.waiting ? "A new version waits: it comes when every tab with this page is closed" : "Ready to work offline";
  };
  registration.addEventListener("updatefound", () => registration.installing?.addEventListener("statechange", tell));
  tell();
}
