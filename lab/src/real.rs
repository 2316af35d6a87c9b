//! Programs that people use on models: every row of their table, and how each is run.
//!
//! `cargo xtask lab --real` installs them, with the scripts in `lab/real` that run what is no program by itself.

use crate::models::gathered;
use meshmark::internals::mesh::Mesh;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use tempfile::TempDir;

/// The exact versions, as they are installed.
const LOCKS: [&str; 3] = [
    include_str!("../real/package.json"),
    include_str!("../real/requirements.txt"),
    include_str!("../real/requirements-blender.txt"),
];

/// By how much a side of the bounding box may change, as a fraction of its diagonal, before a result is another shape.
const TOLERANCE: f64 = 0.2;

/// How a compressed file names what it needs.
const COMPRESSIONS: [&[u8]; 2] = [b"draco_mesh_compression", b"meshopt_compression"];

#[derive(Clone, Copy, PartialEq)]
enum Program {
    GltfTransform,
    Gltfpack,
    Meshoptimizer,
    MeshLab,
    Open3d,
    Trimesh,
    FastSimplification,
    Blender,
}

use Program::{
    Blender, FastSimplification, GltfTransform, Gltfpack, MeshLab, Meshoptimizer, Open3d, Trimesh,
};

/// Every row: a program, and what it is told.
const ROWS: [(Program, &str); 47] = [
    (GltfTransform, "weld"),
    (GltfTransform, "unweld"),
    (GltfTransform, "dedup"),
    (GltfTransform, "reorder"),
    (GltfTransform, "flatten"),
    (GltfTransform, "join"),
    (GltfTransform, "quantize"),
    (GltfTransform, "simplify --ratio 0.5 --error 1"),
    (GltfTransform, "optimize"),
    (GltfTransform, "meshopt"),
    (GltfTransform, "draco"),
    (GltfTransform, "draco --quantize-position 11"),
    (GltfTransform, "draco --quantize-position 8"),
    (Gltfpack, "-cc"),
    (Gltfpack, "-si 0.5"),
    (Gltfpack, "-vp 12"),
    (Gltfpack, "-cc -si 0.5 -vp 12"),
    (Meshoptimizer, "simplify 50%"),
    (Meshoptimizer, "simplify 10%"),
    (Meshoptimizer, "simplifySloppy 50%"),
    (
        MeshLab,
        "meshing_decimation_quadric_edge_collapse targetperc=0.5",
    ),
    (
        MeshLab,
        "meshing_decimation_quadric_edge_collapse targetperc=0.1",
    ),
    (MeshLab, "apply_coord_taubin_smoothing"),
    (MeshLab, "apply_coord_laplacian_smoothing"),
    (MeshLab, "meshing_isotropic_explicit_remeshing"),
    (
        MeshLab,
        "compute_normal_per_vertex generate_surface_reconstruction_screened_poisson depth=8",
    ),
    (
        MeshLab,
        "compute_normal_per_vertex generate_surface_reconstruction_screened_poisson depth=10",
    ),
    (
        Open3d,
        "simplify_quadric_decimation target_number_of_triangles=50%",
    ),
    (
        Open3d,
        "simplify_quadric_decimation target_number_of_triangles=10%",
    ),
    (Open3d, "simplify_vertex_clustering voxel_size=1%"),
    (Open3d, "filter_smooth_taubin number_of_iterations=10"),
    (Open3d, "filter_smooth_laplacian number_of_iterations=3"),
    (Open3d, "subdivide_midpoint number_of_iterations=1"),
    (Open3d, "subdivide_loop number_of_iterations=1"),
    (Trimesh, "obj"),
    (Trimesh, "stl"),
    (Trimesh, "ply"),
    (FastSimplification, "target_reduction=0.5"),
    (FastSimplification, "target_reduction=0.7"),
    (FastSimplification, "target_reduction=0.9"),
    (Blender, "re-export"),
    (Blender, "transform_apply"),
    (Blender, "DECIMATE ratio=0.5"),
    (Blender, "DECIMATE ratio=0.1"),
    (Blender, "SMOOTH iterations=5"),
    (Blender, "REMESH mode=VOXEL voxel_size=0.5%"),
    (Blender, "SUBSURF levels=1"),
];

impl Program {
    /// What people call it.
    fn title(self) -> &'static str {
        match self {
            GltfTransform => "glTF-Transform",
            Gltfpack => "gltfpack",
            Meshoptimizer => "meshoptimizer",
            MeshLab => "MeshLab",
            Open3d => "Open3D",
            Trimesh => "trimesh",
            FastSimplification => "fast_simplification",
            Blender => "Blender",
        }
    }

    /// What its registry calls it.
    fn package(self) -> &'static str {
        match self {
            GltfTransform => "@gltf-transform/cli",
            Gltfpack => "gltfpack",
            Meshoptimizer => "meshoptimizer",
            MeshLab => "pymeshlab",
            Open3d => "open3d-cpu",
            Trimesh => "trimesh",
            FastSimplification => "fast-simplification",
            Blender => "bpy",
        }
    }

    /// The version in the lock files; empty where there is none.
    fn version(self) -> &'static str {
        let lines = || LOCKS.iter().flat_map(|lock| lock.lines());
        let npm = format!("\"{}\": \"", self.package());
        let python = format!("{}==", self.package());
        let version = lines().find_map(|line| {
            let line = line.trim();
            let rest = line.strip_prefix(&npm).or(line.strip_prefix(&python))?;
            rest.split('"').next()
        });
        version.unwrap_or_default()
    }

    /// The command that makes a file of another.
    fn command(self, folder: &Path, words: &str, source: &Path, target: &Path) -> Command {
        let words = words.split(' ');
        let node = |script: &str| {
            let mut command = Command::new("node");
            command.arg(folder.join(script));
            command
        };
        let python = |environment: &str, script: &str| {
            let mut command = Command::new(folder.join(environment).join("bin/python"));
            command.arg(folder.join(script));
            command
        };
        let mut command = match self {
            GltfTransform => node("node_modules/@gltf-transform/cli/bin/cli.js"),
            Gltfpack => node("node_modules/gltfpack/cli.js"),
            Meshoptimizer => node("meshoptimizer.mjs"),
            MeshLab => python("python", "in_meshlab.py"),
            Open3d => python("python", "in_open3d.py"),
            Trimesh => python("python", "round_trip.py"),
            FastSimplification => python("python", "in_fast_simplification.py"),
            Blender => python("blender", "in_blender.py"),
        };
        match self {
            GltfTransform => {
                let (first, rest) = (words.clone().take(1), words.skip(1));
                command.args(first).args([source, target]).args(rest)
            }
            Gltfpack => command
                .arg("-i")
                .arg(source)
                .arg("-o")
                .arg(target)
                .args(words),
            _ => command.args([source, target]).args(words),
        };
        command
    }
}

/// A row of the table.
pub struct Tool {
    /// The program and what it is told.
    pub name: String,
    /// The program and its version.
    pub program: String,
    runner: (Program, &'static str),
    folder: PathBuf,
}

/// Installs the programs into `folder`, unless they are there.
///
/// # Errors
/// What the terminal says is missing.
pub fn install(folder: &Path, with_blender: bool) -> Result<(), String> {
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("real/set-up.sh");
    let mut set_up = Command::new("sh");
    set_up.arg(script).arg(folder);
    set_up.args(with_blender.then_some("--blender"));
    let is_done = set_up.status().is_ok_and(|status| status.success());
    let missing = "programs are missing: see above; the Containerfile has all that they take";
    is_done.then_some(()).ok_or_else(|| missing.to_owned())
}

/// Every row; `folder` is where the programs are installed.
pub fn tools(folder: &Path, with_blender: bool) -> Vec<Tool> {
    ROWS.into_iter()
        .filter(|(program, _)| with_blender || *program != Blender)
        .map(|(program, words)| Tool {
            name: format!("{} {words}", program.title()),
            program: format!("{} {}", program.title(), program.version()),
            runner: (program, words),
            folder: folder.to_owned(),
        })
        .collect()
}

impl Tool {
    /// What the tool makes of a `.glb`, as a `.glb` without compression.
    ///
    /// # Errors
    /// The tool's own words, or that the result is no mesh of about the model's shape.
    pub fn run(&self, model: &[u8]) -> Result<Vec<u8>, String> {
        let (program, words) = self.runner;
        let scratch = TempDir::new().map_err(|error| format!("a folder for files: {error}"))?;
        let [source, result, plain] =
            ["source.glb", "result.glb", "plain.glb"].map(|name| scratch.path().join(name));
        fs::write(&source, model).map_err(|error| format!("{}: {error}", source.display()))?;
        let mut bytes = produced(
            &mut program.command(&self.folder, words, &source, &result),
            &result,
        )?;
        if is_compressed(&bytes) {
            let mut decode = Command::new("node");
            decode.arg(self.folder.join("decode.mjs"));
            bytes = produced(decode.args([&result, &plain]), &plain)?;
        }
        let (before, after) = (sides(&gathered(model)?), sides(&gathered(&bytes)?));
        let is_alike = |(a, b): (&f64, &f64)| (a - b).abs() <= TOLERANCE;
        if before.iter().zip(&after).all(is_alike) {
            Ok(bytes)
        } else {
            Err(format!(
                "not the model's shape: sides {before:.2?} of the diagonal are {after:.2?} now"
            ))
        }
    }
}

/// The file that a command wrote, or what it complained of.
fn produced(command: &mut Command, file: &Path) -> Result<Vec<u8>, String> {
    let program = command.get_program().to_string_lossy().into_owned();
    let output = command
        .env("NO_COLOR", "1")
        .env("OMP_WAIT_POLICY", "passive") // or threads that wait keep other rows from the cores
        .output()
        .map_err(|error| format!("{program}: {error}"))?;
    let said = [&output.stderr[..], &output.stdout].map(String::from_utf8_lossy);
    match fs::read(file) {
        Ok(bytes) if output.status.success() => Ok(bytes),
        _ => Err(complaint(&said.join("\n"), &output.status.to_string())),
    }
}

/// The line of a program's output that says what went wrong: the last one about an error, else the last one.
fn complaint(said: &str, status: &str) -> String {
    let lines = || said.lines().map(str::trim).filter(|line| !line.is_empty());
    lines()
        .rfind(|line| line.to_lowercase().contains("error"))
        .or(lines().next_back())
        .unwrap_or(status)
        .to_owned()
}

fn is_compressed(glb: &[u8]) -> bool {
    COMPRESSIONS
        .iter()
        .any(|name| glb.windows(name.len()).any(|bytes| bytes == *name))
}

/// The bounding box's sides as fractions of its diagonal, shortest first: what turns by right angles and scales leave.
fn sides(mesh: &Mesh) -> [f64; 3] {
    let low = mesh.positions.iter().copied().reduce(|a, b| a.min(b));
    let high = mesh.positions.iter().copied().reduce(|a, b| a.max(b));
    let size = high.unwrap_or_default() - low.unwrap_or_default();
    let mut sides = size.normalize_or_zero().to_array();
    sides.sort_by(f64::total_cmp);
    sides
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;
    use meshmark::internals::mesh::shapes;
    use meshmark::internals::scene::to_glb;

    #[test]
    fn rows_have_names_of_their_own_and_programs_versions() {
        let tools = tools(Path::new("nowhere"), true);
        let mut names: Vec<&str> = tools.iter().map(|tool| tool.name.as_str()).collect();
        names.sort();
        names.dedup();
        assert_eq!(names.len(), ROWS.len());
        for tool in &tools {
            let version = tool.program.rsplit(' ').next().unwrap_or_default();
            assert!(
                version.starts_with(|c: char| c.is_ascii_digit()),
                "{}",
                tool.program
            );
        }
    }

    #[test]
    fn blender_is_run_only_when_asked_for() {
        let blender = |tools: Vec<Tool>| tools.iter().any(|tool| tool.name.contains("Blender"));
        assert!(!blender(tools(Path::new("nowhere"), false)));
        assert!(blender(tools(Path::new("nowhere"), true)));
    }

    #[test]
    fn what_is_not_installed_says_so() {
        let model = to_glb(&shapes::low_poly());
        for tool in tools(Path::new("nowhere"), true) {
            assert!(tool.run(&model).is_err(), "{}", tool.name);
        }
    }

    #[test]
    fn a_complaint_is_the_line_about_the_error() {
        let said = "reading\nTypeError: no such mesh\n    at main\n\nNode.js v20\n";
        assert_eq!(complaint(said, "exit 1"), "TypeError: no such mesh");
        assert_eq!(complaint("\n cannot\n", "exit 1"), "cannot");
        assert_eq!(complaint("", "exit 1"), "exit 1");
    }

    #[test]
    fn compressed_files_are_told_from_plain_ones() {
        let plain = to_glb(&shapes::low_poly());
        assert!(!is_compressed(&plain));
        assert!(is_compressed(
            &[&plain[..], b"KHR_draco_mesh_compression"].concat()
        ));
        assert!(is_compressed(
            &[&plain[..], b"EXT_meshopt_compression"].concat()
        ));
    }

    #[test]
    fn sides_forget_axes_and_scale_alone() {
        let mesh = shapes::low_poly();
        let moved = |f: fn(DVec3) -> DVec3| {
            sides(&mesh.with_positions(mesh.positions.iter().map(|p| f(*p)).collect()))
        };
        let distance = |other: [f64; 3]| {
            (DVec3::from(other) - DVec3::from(sides(&mesh)))
                .abs()
                .max_element()
        };
        assert!(distance(moved(|p| DVec3::new(p.z, -p.x, p.y) * 100.0)) < 1e-9);
        assert!(distance(moved(|p| p * DVec3::new(1.0, 0.0, 1.0))) > TOLERANCE);
    }
}
