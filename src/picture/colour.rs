//! Colours as sRGB components, 0 to 1.

/// One of these.
pub type Colour = [f32; 3];

/// Viridis (van der Walt and Smith, 2015) by five of its colours: even to the eye, and in grey, and to the colour-blind.
const STOPS: [[u8; 3]; 5] = [
    [0x44, 0x01, 0x54],
    [0x3b, 0x52, 0x8b],
    [0x21, 0x91, 0x8c],
    [0x5e, 0xc9, 0x62],
    [0xfd, 0xe7, 0x25],
];

/// The colour at `t`, 0 to 1.
pub fn viridis(t: f32) -> Colour {
    let x = t.clamp(0.0, 1.0) * (STOPS.len() - 1) as f32;
    let i = (x as usize).min(STOPS.len() - 2);
    let part = x - i as f32;
    std::array::from_fn(|c| {
        let (a, b) = (f32::from(STOPS[i][c]), f32::from(STOPS[i + 1][c]));
        (a + (b - a) * part) / 255.0
    })
}
