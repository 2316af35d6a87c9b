//! What others have published, beside which docs/ROBUSTNESS.md puts its own.

/// Wrong bits of 64 on the model Venus of the LIRIS benchmark, as fractions: its page "results_venus" (Wang et al. 2010), averages of
/// five marks. The columns are [`METHODS`]; rows for simplification and cropping were not to be had.
pub const BENCHMARK: [(&str, [f64; 4]); 16] = [
    ("noise 0.05 %", [0.01, 0.0, 0.0, 0.02]),
    ("noise 0.1 %", [0.03, 0.01, 0.01, 0.15]),
    ("noise 0.3 %", [0.13, 0.08, 0.10, 0.29]),
    ("noise 0.5 %", [0.28, 0.16, 0.24, 0.40]),
    ("Laplacian 5", [0.10, 0.0, 0.06, 0.06]),
    ("Laplacian 10", [0.23, 0.01, 0.16, 0.18]),
    ("Laplacian 30", [0.38, 0.07, 0.34, 0.39]),
    ("Laplacian 50", [0.45, 0.14, 0.42, 0.51]),
    ("quantize 11 bits", [0.0, 0.0, 0.0, 0.01]),
    ("quantize 10 bits", [0.04, 0.01, 0.02, 0.17]),
    ("quantize 9 bits", [0.14, 0.01, 0.06, 0.27]),
    ("quantize 8 bits", [0.26, 0.05, 0.18, 0.39]),
    ("quantize 7 bits", [0.46, 0.17, 0.41, 0.53]),
    ("midpoint", [0.04, 0.0, 0.02, 0.0]),
    ("square root of 3", [0.14, 0.0, 0.09, 0.01]),
    ("Loop", [0.16, 0.0, 0.09, 0.01]),
];

/// Each with its RMS distortion in percent of the diagonal, and its MSDM.
pub const METHODS: [&str; 4] = [
    "Cho et al. 2007 (0.0080 %, 0.19)",
    "Wang et al. 2011 (0.069 %, 0.14)",
    "Cho et al. 2007 (0.012 %, 0.29)",
    "Wang et al. 2011 (0.018 %, 0.09)",
];

/// What Aspose.3D 26.9.0's text watermark was measured to survive on two models, cow and Stanford bunny, in its trial version. It leaves
/// the geometry as it is, and needs no password to be read.
pub const ASPOSE: [(&str, &str, &str); 14] = [
    ("a wrong password", "reads the text", "reads the text"),
    ("reorder", "lost", "lost"),
    ("similarity", "survives", "survives"),
    ("noise of 0.001 % of the diagonal", "survives", "survives"),
    ("noise of 0.01 %", "lost", "lost"),
    ("Laplacian 1", "lost", "lost"),
    ("simplify to 90 %", "lost", "lost"),
    ("quantize 14 bits", "survives", "survives"),
    ("quantize 11 bits", "lost", "lost"),
    ("triangle soup", "survives", "lost"),
    ("crop 10 %", "survives", "lost"),
    ("mirrored copy", "lost", "lost"),
    ("glTF-Transform weld", "survives", "lost"),
    (
        "glTF-Transform reorder, meshopt, draco or simplify",
        "lost",
        "lost",
    ),
];
