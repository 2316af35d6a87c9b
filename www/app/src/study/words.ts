/** The study's names in words. */
import type { Errors, Finding, Hosts, Preparation, Ranking, Rule, Smoothing } from "../../research-wasm/research.js";

export const PREPARATIONS: Record<Preparation, { name: string; hint: string }> = {
  optimize: { name: "Optimize (face threshold)", hint: "The paper’s: leaves thin triangles. A model that is no larger stays as it is." },
  simplify: { name: "Quadric errors", hint: "Leaves triangles that follow the shape. A model that is no larger stays as it is." },
};

export const RANKINGS: Record<Ranking, { name: string; hint: string }> = {
  literal: { name: "Literal", hint: "All that the paper names: curvatures, dihedral angles, normals, collapse cost." },
  integrated: { name: "Integrated", hint: "The same, integrated over each vertex’s cell: it does not grow where a mesh is refined." },
  collapse: { name: "Collapse cost", hint: "The cost of the cheapest collapse alone: the best predictor of who is found again." },
};

export const SMOOTHINGS: Record<Smoothing, { name: string; hint: string }> = {
  meshSmooth: { name: "MeshSmooth (Catmull–Clark)", hint: "The paper’s. Subdivides: new vertices compete with the old ones." },
  loop: { name: "Loop", hint: "Subdivides every triangle in four, and smooths." },
  sqrt3: { name: "√3 (Kobbelt)", hint: "Subdivides every triangle in three, and smooths." },
  midpoint: { name: "Midpoint", hint: "Divides every triangle in four and moves nothing." },
  laplacian: { name: "Laplacian", hint: "Half a step towards the mean of the neighbours; shrinks." },
  bilaplacian: { name: "Bilaplacian", hint: "Half a step of the umbrella operator’s square." },
  meanCurvatureFlow: { name: "Mean curvature flow", hint: "Implicit, for half a square of the mean edge." },
  taubin: { name: "Taubin λ|μ", hint: "λ 0.5, μ −0.53: smooths without shrinking." },
  meanFilter: { name: "Mean filter of normals", hint: "Averages face normals and fits the vertices to them: the paper’s eqs. 2 to 4." },
};

export const RULES: Record<Rule, { name: string; hint: string }> = {
  index: { name: "By index", hint: "Of the N best of all vertices after smoothing, those that were there before." },
  region: { name: "By region", hint: "Vertices that have one of those N best near where they were." },
  overlap: { name: "Hosts again", hint: "Of the hosts, those that are among as many best vertices afterwards: what blind detection has to go on." },
};

export const HOSTS: Record<Hosts, string> = {
  random: "Random",
  literal: "Literal",
  integrated: "Integrated",
  collapse: "Collapse cost",
  all: "Cells",
};

export const FINDINGS: Record<Exclude<Finding, "cells">, { name: string; hint: string }> = {
  traced: { name: "Traced", hint: "Where each host went is known: the paper’s assumption." },
  ranked: { name: "Blind", hint: "The suspect is ranked again: the paper’s way without the original." },
  original: { name: "With original", hint: "Hosts are looked for where the original has them." },
};

export const MEASURES: Record<"raw" | "payload", { name: string; axis: string }> = {
  raw: { name: "Raw", axis: "wrong symbols" },
  payload: { name: "Decoded", axis: "wrong bits" },
} satisfies Partial<Record<keyof Errors, unknown>>;

export function times(iterations: number): string {
  return iterations === 1 ? "1 iteration" : `${iterations} iterations`;
}
