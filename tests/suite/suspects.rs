//! Suspects that are no glTF: positions and triangles.

use crate::portable_test;
use crate::support::fixtures::{key, marked};
use meshmark::internals::document::Document;
use meshmark::{Files, Surface, Verdict, demo_model, detect, extract, measure, verify};
use std::ops::ControlFlow;

type Triangles = (Vec<[f64; 3]>, Vec<[u32; 3]>);

/// A marked model's elements, as its file has them.
fn copy() -> (Vec<u8>, Triangles) {
    let model = marked(&demo_model(), &key(1)).unwrap().model;
    let document = Document::read(&model, &Files::new()).unwrap();
    let accessor = document.meshes()[0].primitives[0].position.unwrap();
    let triangles = document.triangles(0, 0).unwrap();
    let positions = document.positions(accessor).unwrap();
    (model, (positions, triangles))
}

fn soup((positions, triangles): &Triangles) -> Triangles {
    let corners = triangles.iter().flatten();
    let corners: Vec<[f64; 3]> = corners.map(|&corner| positions[corner as usize]).collect();
    let triangles =
        (0..corners.len() as u32 / 3).map(|first| [0, 1, 2].map(|corner| 3 * first + corner));
    let triangles = triangles.collect();
    (corners, triangles)
}

#[portable_test]
fn suspects_in_any_form_are_measured_as_the_model_is() {
    let (model, (positions, triangles)) = copy();
    let surface = || Surface::new(&positions, &triangles);
    let evidence = measure(surface()).unwrap();
    assert_eq!(evidence, measure(&model).unwrap());
    assert_eq!(extract(&evidence, &key(1)).verdict, Verdict::Found);
    let payload = crate::support::fixtures::payload();
    assert_eq!(verify(&evidence, &key(1), payload).verdict, Verdict::Found);
    let [as_surface, as_model] = [
        detect(surface(), &key(1), None),
        detect(&model, &key(1), None),
    ];
    assert_eq!(as_surface.unwrap(), as_model.unwrap());
    assert_eq!(
        detect(surface(), &key(2), None).unwrap().verdict,
        Verdict::None
    );
}

/// What writing in another format does: Z up, millimetres, numbers of six digits, triangles with vertices of their own.
#[portable_test]
fn suspects_from_other_formats_are_found() {
    let (_, copy) = copy();
    let six_digits = |number: f64| -> f64 { format!("{number:.5e}").parse().unwrap() };
    let written = |[x, y, z]: [f64; 3]| [x, -z, y].map(|number| six_digits(1000.0 * number));
    for (positions, triangles) in [soup(&copy), copy] {
        let positions: Vec<[f64; 3]> = positions.into_iter().map(written).collect();
        let answer = detect(Surface::new(&positions, &triangles), &key(1), None).unwrap();
        assert_eq!(
            (answer.verdict, answer.tag.as_deref()),
            (Verdict::Found, Some("ADA-1"))
        );
    }
}

#[portable_test]
fn suspects_that_are_no_surface_are_refused() {
    let positions = [
        [0.0; 3],
        [1.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [f64::NAN, 0.0, 0.0],
    ];
    let refused = |triangles: &[[u32; 3]]| {
        measure(Surface::new(&positions, triangles))
            .err()
            .map(|error| error.code())
    };
    assert_eq!(refused(&[[0, 1, 2]]), None);
    assert_eq!(refused(&[[0, 1, 4]]), Some("scene.no-vertex"));
    assert_eq!(refused(&[[0, 1, 3]]), Some("scene.not-a-number"));
    assert_eq!(refused(&[[0, 1, 1]]), Some("scene.no-triangles"));
    assert_eq!(refused(&[]), Some("scene.no-triangles"));
}

#[portable_test]
fn suspects_are_watched_in_any_form() {
    let mut stop = |_, _| ControlFlow::Break(());
    let surface = Surface::new(&[[0.0; 3]; 3], &[[0, 1, 2]]).with_progress(&mut stop);
    assert_eq!(
        measure(surface).err().map(|error| error.code()),
        Some("aborted")
    );
}
