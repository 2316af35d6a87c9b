/** Whether a model can hold a mark, in words: the same to whoever marks it and to whoever looks for a mark in it. */
import type { Inspection } from "meshmark";
import { CARRIERS, count } from "./words";

type Capacity = Inspection["capacity"];

/** What a model lacks for a mark; `null` where it lacks nothing. */
export function capacityWords(capacity: Capacity): string | null {
  const short = capacity.filter(({ addresses, neededAddresses }) => addresses < neededAddresses);
  const lacking = short
    .map(({ name, addresses, neededAddresses }) => `its ${CARRIERS[name].home} offers ${count(addresses)} of the ${count(neededAddresses)} places that are needed`)
    .join(", ");
  const [enough] = capacity.filter((carrier) => !short.includes(carrier));
  if (short.length === 0) {
    return null;
  }
  const places = "Places are where symbols of a mark can stand.";
  return enough
    ? `At most the ${CARRIERS[enough.name].home} of this model can hold a mark: ${lacking}. ${places}`
    : `This model is too small or too regular to hold a mark: ${lacking}. ${places}`;
}
