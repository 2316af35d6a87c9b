//! The picture in a statement: a suspect laid on its original.

use super::overlay::{Overlay, Sheet};
use crate::picture::{Colour, Painted, Picture, View, viridis};
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use glam::DVec3;

/// The side of a panel, in pixels.
const PANEL: usize = 440;
const PANELS: usize = 3;
const ORIGINAL: Colour = [0.80, 0.77, 0.72];
const SUSPECT: Colour = [0.47, 0.66, 0.82];
const PALE: Colour = [0.95, 0.94, 0.92];
const CUT: Colour = [0.82, 0.82, 0.82];
const ADDED: Colour = [0.86, 0.30, 0.16];
/// How much nearer one surface is drawn than the other that it lies on, in radii.
const LIFTED: f64 = 0.02;

/// What its classes look like.
pub(super) const STYLE: &str = "figure{margin:1.2rem 0}img{width:100%;display:block}figcaption{font-size:.9rem}\
    .thirds{display:grid;grid-template-columns:1fr 1fr 1fr;text-align:center}\
    .scale,.key{display:inline-block;height:.8em;width:.8em;border:1px solid #777;-webkit-print-color-adjust:exact;print-color-adjust:exact}\
    .scale{width:6em;background:linear-gradient(90deg,#440154,#3b528b,#21918c,#5ec962,#fde725)}.cut{background:#d1d1d1}.added{background:#db4d29}";

/// The picture of an overlay in a statement, with a caption. What makes it is linked where it is asked for: most statements have none.
#[derive(Clone, Debug, PartialEq)]
pub struct Illustration {
    pub(super) html: String,
    /// How many triangles the suspect has where the two are near each other, as a share of the original's there; `None` where the original is a record's, which
    /// has few.
    pub(super) triangles: Option<f64>,
}

impl Illustration {
    /// Draws an overlay: the original, the suspect on it, and how far they are apart; nothing that follows the key.
    pub fn of(overlay: &Overlay) -> Illustration {
        Illustration {
            html: figure(overlay),
            triangles: (!overlay.is_recorded).then(|| share_of_triangles(overlay)),
        }
    }
}

fn share_of_triangles(overlay: &Overlay) -> f64 {
    let num_near = |sheet, values| parted(sheet, values).0.len() as f64;
    num_near(&overlay.suspect, &overlay.additions)
        / num_near(&overlay.original, &overlay.differences).max(1.0)
}

fn figure(overlay: &Overlay) -> String {
    let end = 100.0 * overlay.most_difference;
    let recorded = match overlay.is_recorded {
        true => {
            " The original is what the record keeps of it, in few triangles: what differs a little is the record."
        }
        false => "",
    };
    format!(
        "<figure><img alt=\"Three pictures from the same side: the original, the suspect where it lies on the original, and how far they are from \
         each other\" src=\"data:image/png;base64,{}\">\n\
         <figcaption><div class=\"thirds\"><span>The original</span><span>The suspect, laid on it</span><span>How far apart they are</span></div>\n\
         <p>In the middle the original is pale. On the right, as a share of the original\u{2019}s diagonal: \
         <span class=\"scale\"></span> 0 to {end:.3} % or more; <span class=\"key cut\"></span> not in the suspect; \
         <span class=\"key added\"></span> not in the original.{recorded}</p></figcaption></figure>\n",
        STANDARD.encode(picture(overlay)),
    )
}

/// The original, the suspect as it lies on it, and how far they are from each other.
fn picture(overlay: &Overlay) -> Vec<u8> {
    let from = DVec3::from_array(overlay.from);
    let view = View::of(&overlay.original.positions, from);
    let mut picture = Picture::new(PANELS * PANEL, PANEL);
    let mut paint =
        |panel, sheet: &Sheet, triangles: &[[u32; 3]], lifted, colour: &dyn Fn(usize) -> Colour| {
            let painted = Painted {
                positions: &sheet.positions,
                triangles,
                colour,
                lifted,
            };
            picture.draw((panel, PANELS), &view, &painted);
        };
    let Overlay {
        original, suspect, ..
    } = overlay;
    paint(0, original, &original.triangles, 0.0, &|_| ORIGINAL);
    paint(1, original, &original.triangles, 0.0, &|_| PALE);
    paint(1, suspect, &suspect.triangles, LIFTED, &|_| SUSPECT);
    let (near, cut) = parted(original, &overlay.differences);
    let (_, added) = parted(suspect, &overlay.additions);
    paint(2, original, &cut, 0.0, &|_| CUT);
    paint(2, suspect, &added, 0.0, &|_| ADDED);
    paint(2, original, &near, 0.0, &|v| {
        viridis(overlay.differences[v] / overlay.most_difference)
    });
    picture.png()
}

/// The triangles whose corners all have a finite value, and the others.
fn parted(sheet: &Sheet, values: &[f32]) -> (Vec<[u32; 3]>, Vec<[u32; 3]>) {
    let is_near = |corners: &[u32; 3]| corners.iter().all(|v| values[*v as usize].is_finite());
    sheet.triangles.iter().copied().partition(is_near)
}
