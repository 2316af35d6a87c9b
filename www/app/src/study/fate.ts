/** What became of hosts: a sign and a colour for each, on the mesh as in the legend. */
export type Fate = "found" | "lost" | "newcomer";

/** Paths are SVG's, in a square of 16. The colours are told apart by the colour-blind (Okabe and Ito). */
export const FATES: Record<Fate, { words: string; path: string; color: string }> = {
  found: { words: "found again", path: "M8 2.5a5.5 5.5 0 1 0 0 11a5.5 5.5 0 1 0 0-11Z", color: "#009e73" },
  lost: { words: "lost", path: "M4.5 2 8 5.5 11.5 2 14 4.5 10.5 8 14 11.5 11.5 14 8 10.5 4.5 14 2 11.5 5.5 8 2 4.5Z", color: "#d55e00" },
  newcomer: { words: "taken in their place", path: "M8 3.2 13 12.4H3Z", color: "#f0e442" },
};

/** Smoothing moves hosts by less than can be seen: their paths are drawn so many times as long. */
export const PATH_SCALE = 10;
