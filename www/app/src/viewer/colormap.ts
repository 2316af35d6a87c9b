/** Viridis (van der Walt and Smith, 2015) by five of its colours: even to the eye, and in grey, and to the colour-blind. */
const STOPS = [
  [0x44, 0x01, 0x54],
  [0x3b, 0x52, 0x8b],
  [0x21, 0x91, 0x8c],
  [0x5e, 0xc9, 0x62],
  [0xfd, 0xe7, 0x25],
] as const;

/** The colour of `t` (0 to 1), as sRGB components from 0 to 1. */
export function colorAt(t: number): [r: number, g: number, b: number] {
  const x = Math.min(Math.max(t, 0), 1) * (STOPS.length - 1);
  const i = Math.min(Math.floor(x), STOPS.length - 2);
  const mix = (c: 0 | 1 | 2) => (STOPS[i]![c] + (STOPS[i + 1]![c] - STOPS[i]![c]) * (x - i)) / 255;
  return [mix(0), mix(1), mix(2)];
}

/** Draws the map from left to right over a canvas. */
export function drawLegend(canvas: HTMLCanvasElement): void {
  const context = canvas.getContext("2d")!;
  for (let x = 0; x < canvas.width; x++) {
    const [r, g, b] = colorAt(x / (canvas.width - 1));
    context.fillStyle = `rgb(${r * 255} ${g * 255} ${b * 255})`;
    context.fillRect(x, 0, 1, canvas.height);
  }
}
