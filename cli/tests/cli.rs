//! The command line, as scripts use it.
#![cfg(not(target_arch = "wasm32"))]
#![allow(clippy::unwrap_used)] // a test that unwraps nothing fails, as it should

use serde_json::{Value, json};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// A folder of its own for one test, gone with it.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Folder {
        let path = std::env::temp_dir().join(format!("meshmark-cli-{name}-{}", std::process::id()));
        fs::create_dir_all(&path).unwrap();
        fs::write(path.join("secret.txt"), "correct horse\n").unwrap();
        fs::write(path.join("other.txt"), "battery staple").unwrap();
        fs::write(path.join("model.glb"), meshmark::demo_model()).unwrap();
        Folder(path)
    }

    /// Runs `meshmark` here: exit code, report, what was said on stderr.
    fn run(&self, arguments: &str) -> (i32, Value, String) {
        self.run_with(arguments, None)
    }

    fn run_with(&self, arguments: &str, passphrase: Option<&str>) -> (i32, Value, String) {
        let mut command = Command::new(env!("CARGO_BIN_EXE_meshmark"));
        command
            .args(arguments.split_whitespace())
            .current_dir(&self.0)
            .stdin(Stdio::null());
        command.env_remove("MESHMARK_PASSPHRASE");
        if let Some(passphrase) = passphrase {
            command.env("MESHMARK_PASSPHRASE", passphrase);
        }
        let output = command.output().unwrap();
        let report = serde_json::from_slice(&output.stdout).unwrap_or(Value::Null);
        (
            output.status.code().unwrap(),
            report,
            String::from_utf8(output.stderr).unwrap(),
        )
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.join(name)
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        fs::remove_dir_all(&self.0).unwrap();
    }
}

const ADA: &str = "--owner Ada --passphrase-file secret.txt";

#[test]
fn attacks_are_listed_and_made_by_their_names() {
    let folder = Folder::new("attack");
    let (code, list, _) = folder.run("attacks");
    assert_eq!(code, 0);
    let noise = list
        .as_array()
        .unwrap()
        .iter()
        .find(|a| a["name"] == "noise");
    assert_eq!(noise.unwrap()["steps"][1], "noise 0.1 %");

    let attack = |words: &[&str]| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_meshmark"));
        let output = command.args(words).current_dir(&folder.0).output().unwrap();
        let report = serde_json::from_slice(&output.stdout).unwrap_or(Value::Null);
        (output.status.code(), report)
    };
    let steps = [
        "--step",
        "simplify 50",
        "--step",
        "noise 0.1 %",
        "--seed",
        "7",
    ];
    let words = [&["attack", "model.glb", "attacked.glb"], &steps[..]].concat();
    let (code, report): (_, Value) = attack(&words);
    assert_eq!(code, Some(0));
    assert_eq!(report["steps"][0], "simplify 50 %");
    assert_eq!(report["seed"], 7);
    let rms = report["rmsRel"].as_f64().unwrap();
    assert!((1e-5..1e-2).contains(&rms), "{rms}");
    let (_, inspected, _) = folder.run("inspect attacked.glb");
    assert_eq!(inspected["vertices"], report["vertices"]);
    let first = fs::read(folder.path("attacked.glb")).unwrap();
    attack(&words);
    assert_eq!(fs::read(folder.path("attacked.glb")).unwrap(), first);

    let (code, _) = attack(&["attack", "model.glb", "x.glb", "--step", "noise 0.2"]);
    assert_eq!(code, Some(2));
    assert!(!folder.path("x.glb").exists());
}

#[test]
fn cli_embeds_and_extracts() {
    let here = Folder::new("roundtrip");
    let (code, report, _) = here.run(&format!("embed model.glb marked.glb {ADA} --tag ADA-1"));
    assert_eq!(code, 0);
    assert_eq!(report["tag"], "ADA-1");
    assert_eq!(report["vertices"], 12_002);
    assert_eq!(report["readBack"]["verdict"], "found");
    for stage in ["read", "embed", "write", "measure", "test", "forecast"] {
        assert!(
            report["ms"][stage].is_number(),
            "{stage} is timed: {report}"
        );
    }
    let (code, report, _) = here.run(&format!("extract marked.glb {ADA}"));
    assert_eq!(
        (code, &report["verdict"], &report["tag"]),
        (0, &"found".into(), &"ADA-1".into())
    );
    assert_eq!(report["input"], "model");
    assert!(report["lnP"].as_f64().unwrap() < -100.0);
    assert_eq!(report["carriers"][0]["name"], "solid");
    assert_eq!(report["carriers"][0]["tag"], "ADA-1");
    assert!(
        ["read", "measure", "test"]
            .iter()
            .all(|stage| report["ms"][stage].is_number()),
        "{report}"
    );

    let other = "--owner Ada --passphrase-file other.txt";
    let (code, report, _) = here.run(&format!("extract marked.glb {other}"));
    assert_eq!((code, &report["verdict"]), (1, &"none".into()));
    for name in ["lnP", "agreement", "carriers"] {
        assert_eq!(report.get(name), None, "{name} follows the key");
    }
    let (code, report, _) = here.run(&format!("extract marked.glb {other} --details"));
    assert_eq!((code, &report["verdict"]), (1, &"none".into()));
    assert!(report["carriers"][1]["ownedAddresses"].is_number());
    let (code, report, _) = here.run(&format!("verify marked.glb {ADA} --tag ADA-1"));
    assert_eq!((code, &report["verdict"]), (0, &"found".into()));
    let (code, report, _) = here.run(&format!("verify marked.glb {ADA} --number 7"));
    assert_eq!((code, &report["verdict"]), (1, &"partial".into()));
    assert_eq!(report.get("carriers"), None);
}

/// A piece that was cut out and simplified is found by LOCAL, where it is looked for.
#[test]
fn cli_finds_a_piece_by_local() {
    let here = Folder::new("local");
    let part = meshmark::internals::mesh::shapes::cad_part();
    fs::write(
        here.path("part.glb"),
        meshmark::internals::scene::to_glb(&part),
    )
    .unwrap();
    let (code, report, _) = here.run(&format!(
        "embed part.glb marked.glb {ADA} --tag ADA-1 --strength strong --carriers solid,ring,local"
    ));
    assert_eq!((code, &report["readBack"]["tag"]), (0, &"ADA-1".into()));
    let steps = [
        "--step",
        "crop 50 %",
        "--step",
        "simplify 50",
        "--seed",
        "3",
    ];
    let mut command = Command::new(env!("CARGO_BIN_EXE_meshmark"));
    command
        .args(["attack", "marked.glb", "piece.glb"])
        .args(steps);
    assert!(
        command
            .current_dir(&here.0)
            .output()
            .unwrap()
            .status
            .success()
    );

    let (code, report, _) = here.run(&format!("extract piece.glb {ADA}"));
    assert_eq!((code, &report["verdict"]), (1, &"none".into()));
    for command in ["extract", "verify --tag ADA-1"] {
        let (code, report, _) = here.run(&format!("{command} piece.glb --local {ADA}"));
        assert_eq!(
            (code, &report["verdict"]),
            (0, &"present".into()),
            "{command}"
        );
        let reason = report["reason"].as_str().unwrap();
        assert!(reason.starts_with("Found by LOCAL, in "), "{reason}");
        assert_eq!(report["carriers"][2]["name"], "local");
    }
    let other = "--owner Ada --passphrase-file other.txt";
    let (code, report, _) = here.run(&format!("extract piece.glb --local {other}"));
    assert_eq!((code, &report["verdict"]), (1, &"none".into()));

    let (code, ..) = here.run(&format!("extract piece.glb --local --evidence {ADA}"));
    assert_eq!(code, 2);
    let (code, _, words) = here.run(&format!(
        "embed part.glb x.glb {ADA} --tag ADA-1 --carriers local"
    ));
    assert!(
        code == 2 && words.contains("name the carrier solid"),
        "{words}"
    );
}

#[test]
fn cli_measures_once_and_reads_the_evidence() {
    let here = Folder::new("evidence");
    here.run(&format!(
        "embed model.glb marked.glb {ADA} --number 42 --strength strong --carriers ring"
    ));
    let (code, report, _) = here.run("measure marked.glb marked.mmev");
    assert_eq!(code, 0);
    assert_eq!(
        report["bytes"].as_u64().unwrap(),
        fs::metadata(here.path("marked.mmev")).unwrap().len()
    );
    let (code, report, _) = here.run(&format!("extract marked.mmev --evidence {ADA}"));
    assert_eq!(
        (code, &report["number"], &report["input"]),
        (0, &42.into(), &"evidence".into())
    );
    let (code, report, _) = here.run(&format!("verify marked.mmev --evidence {ADA} --number 42"));
    assert_eq!((code, &report["number"]), (0, &42.into()));
}

/// What begins like evidence is not read as such unless somebody asks: it says what its maker likes.
#[test]
fn cli_reads_evidence_only_where_it_is_asked_for() {
    let here = Folder::new("unasked");
    fs::write(here.path("key"), [0xab; 32]).unwrap();
    fs::write(here.path("keys.txt"), "ab".repeat(32)).unwrap();
    here.run("embed model.glb marked.glb --key-file key --tag ADA-1");
    here.run("measure marked.glb suspect.glb");
    for arguments in [
        "extract suspect.glb --key-file key",
        "verify suspect.glb --key-file key --tag ADA-1",
        "test suspect.glb --keys keys.txt",
    ] {
        let (code, report, said) = here.run(arguments);
        let expected: Value = "evidence.not-asked-for".into();
        assert_eq!((code, &report["error"]["code"]), (2, &expected), "{report}");
        assert!(said.contains("--evidence"), "{said}");
        let (code, ..) = here.run(&format!("{arguments} --evidence"));
        assert_eq!(code, 0, "{arguments}");
    }
    let (code, report, _) = here.run("extract model.glb --key-file key --evidence");
    let expected: Value = "evidence.not-evidence".into();
    assert_eq!((code, &report["error"]["code"]), (2, &expected));
}

#[test]
fn cli_takes_the_secret_from_the_environment_or_a_key_file() {
    let here = Folder::new("secret");
    fs::write(here.path("key"), [5; 32]).unwrap();
    here.run(&format!("embed model.glb marked.glb {ADA} --tag X"));
    let (code, ..) = here.run_with("extract marked.glb --owner Ada", Some("correct horse"));
    assert_eq!(code, 0);
    let (code, report, _) = here.run("extract marked.glb --key-file key");
    assert_eq!((code, &report["verdict"]), (1, &"none".into()));
    fs::write(here.path("key"), [5; 31]).unwrap();
    let (code, report, _) = here.run("extract marked.glb --key-file key");
    assert_eq!((code, &report["error"]["code"]), (2, &"key.length".into()));
}

/// A list of keys finds the owner's and no other, and charges for its length.
#[test]
fn cli_tests_a_list_of_keys() {
    let here = Folder::new("keys");
    fs::write(here.path("key"), [0xab; 32]).unwrap();
    here.run("embed model.glb marked.glb --key-file key --tag ADA-1");
    here.run("measure marked.glb marked.mmev");
    let list = format!("# ours\n{} Ada\n\n{}\n", "ab".repeat(32), "cd".repeat(32));
    fs::write(here.path("keys.txt"), list).unwrap();
    let (code, report, _) = here.run("test marked.mmev --evidence --keys keys.txt");
    assert_eq!((code, &report["input"]), (0, &"evidence".into()));
    assert_eq!(report["numKeys"], 2);
    assert_eq!(report["lnCharge"], libm::log(2.0));
    let keys = report["keys"].as_array().unwrap();
    assert_eq!(keys[0]["key"], "Ada");
    assert_eq!(
        (&keys[0]["found"], &keys[0]["tag"]),
        (&true.into(), &"ADA-1".into())
    );
    assert_eq!(keys[1], json!({ "key": "line 4", "found": false }));

    let digits = [
        "not a key",
        &"+b".repeat(32),
        &"ab".repeat(31),
        &"aé".repeat(32),
    ];
    for digits in digits {
        fs::write(here.path("keys.txt"), digits).unwrap();
        let (code, report, _) = here.run("test marked.mmev --evidence --keys keys.txt");
        assert_eq!(code, 2, "{digits}");
        let message = report["error"]["message"].as_str().unwrap();
        assert!(message.contains("line 1"), "{message}");
    }
    fs::write(here.path("keys.txt"), "# none\n").unwrap();
    let (code, ..) = here.run("test marked.mmev --evidence --keys keys.txt");
    assert_eq!(code, 2, "a list without keys says nothing");
}

/// A work has a key of its own, and a list of titles is a list of keys.
#[test]
fn cli_keeps_works_apart() {
    let here = Folder::new("works");
    fs::write(here.path("key"), [0xab; 32]).unwrap();
    let key = "--key-file key";
    here.run(&format!(
        "embed model.glb marked.glb {key} --work Rock --tag ADA-1"
    ));
    let (code, report, _) = here.run(&format!("extract marked.glb {key} --work Rock"));
    assert_eq!((code, &report["tag"]), (0, &"ADA-1".into()));
    for other in ["", "--work rock"] {
        let (code, ..) = here.run(&format!("extract marked.glb {key} {other}"));
        assert_eq!(code, 1, "another key: {other}");
    }
    here.run("measure marked.glb marked.mmev");
    fs::write(here.path("works.txt"), "Moon\n\n Rock \n").unwrap();
    let works = "test marked.mmev --evidence --works works.txt";
    let (code, report, _) = here.run(&format!("{works} {key}"));
    assert_eq!((code, &report["lnCharge"]), (0, &libm::log(2.0).into()));
    let found: Vec<&Value> = report["keys"]
        .as_array()
        .unwrap()
        .iter()
        .map(|row| &row["found"])
        .collect();
    assert_eq!(found, [&Value::from(false), &Value::from(true)]);
    let (code, ..) = here.run(works);
    assert_eq!(code, 2, "whose works they are has to be said");
    let (code, report, _) = here.run(&format!("embed model.glb x.glb {key} --tag A --work"));
    assert_eq!(code, 2, "{report}");
}

#[test]
fn cli_reads_and_writes_external_buffers() {
    let here = Folder::new("external");
    let glb = meshmark::demo_model();
    let json_length = u32::from_le_bytes(glb[12..16].try_into().unwrap()) as usize;
    let json = String::from_utf8(glb[20..20 + json_length].to_vec()).unwrap();
    let json = json.replace(
        r#""buffers":[{"#,
        r#""buffers":[{"uri":"model%20data.bin","#,
    );
    fs::write(here.path("model.gltf"), json).unwrap();
    fs::write(here.path("model data.bin"), &glb[20 + json_length + 8..]).unwrap();
    fs::create_dir(here.path("out")).unwrap();
    let (code, report, said) = here.run(&format!(
        "embed model.gltf out/model.gltf {ADA} --tag ADA-1"
    ));
    assert_eq!(code, 0, "{report} {said}");
    let (code, ..) = here.run(&format!("extract out/model.gltf {ADA}"));
    assert_eq!(code, 0);
    fs::remove_file(here.path("out/model data.bin")).unwrap();
    let (code, report, said) = here.run(&format!("extract out/model.gltf {ADA}"));
    assert_eq!((code, &report["verdict"]), (2, &"cannot-check".into()));
    assert!(said.contains("model data.bin"), "{said}");
}

#[test]
fn cli_never_overwrites_the_host_nor_leaves_its_folder() {
    let here = Folder::new("overwrite");
    let uri = |uri: &str| {
        let glb = meshmark::demo_model();
        let json_length = u32::from_le_bytes(glb[12..16].try_into().unwrap()) as usize;
        let json = String::from_utf8(glb[20..20 + json_length].to_vec()).unwrap();
        let member = format!(r#""buffers":[{{"uri":"{uri}","#);
        fs::write(
            here.path("model.gltf"),
            json.replace(r#""buffers":[{"#, &member),
        )
        .unwrap();
        fs::write(here.path("model.bin"), &glb[20 + json_length + 8..]).unwrap();
    };
    uri("model.bin");
    let before = fs::read(here.path("model.bin")).unwrap();
    let (code, _, said) = here.run(&format!("embed model.gltf marked.gltf {ADA} --tag A"));
    assert_eq!(code, 2, "{said}");
    assert!(said.contains("overwritten"), "{said}");
    assert_eq!(fs::read(here.path("model.bin")).unwrap(), before);
    uri("../model.bin");
    let (code, _, said) = here.run(&format!("embed model.gltf marked.gltf {ADA} --tag A"));
    assert_eq!(code, 2);
    assert!(said.contains("outside"), "{said}");
}

/// The demo model as a .gltf whose positions and indices are in files of their own, with textures, one of them not there, and one
/// outside of the folder.
fn write_gltf_of_many_files(here: &Folder) {
    let glb = meshmark::demo_model();
    let json_length = u32::from_le_bytes(glb[12..16].try_into().unwrap()) as usize;
    let mut json: Value = serde_json::from_slice(&glb[20..20 + json_length]).unwrap();
    let binary = &glb[20 + json_length + 8..];
    let views = json["bufferViews"].as_array().unwrap().clone();
    let names = ["buf/positions.bin", "buf/normals.bin", "in dices.bin"];
    fs::create_dir_all(here.path("in/buf")).unwrap();
    let mut buffers = Vec::new();
    for (index, (view, name)) in views.iter().zip(names).enumerate() {
        let length = view["byteLength"].as_u64().unwrap() as usize;
        let start = view["byteOffset"].as_u64().unwrap_or(0) as usize;
        fs::write(here.path("in").join(name), &binary[start..start + length]).unwrap();
        buffers.push(json!({ "byteLength": length, "uri": name.replace(' ', "%20") }));
        json["bufferViews"][index]["buffer"] = json!(index);
        json["bufferViews"][index]["byteOffset"] = json!(0);
    }
    json["buffers"] = json!(buffers);
    json["images"] = json!([
        { "uri": "textures/a%23b.png" },
        { "uri": "lost.png" },
        { "uri": "../outside.png" },
        { "uri": "https://example.org/far.png" },
        { "uri": "data:image/png;base64,AAAA" },
    ]);
    fs::create_dir_all(here.path("in/textures")).unwrap();
    fs::write(here.path("in/textures/a#b.png"), "picture").unwrap();
    fs::write(here.path("outside.png"), "picture").unwrap();
    fs::write(here.path("in/model.gltf"), json.to_string()).unwrap();
}

#[test]
fn cli_writes_all_that_a_gltf_names() {
    let here = Folder::new("complete");
    write_gltf_of_many_files(&here);
    let (code, report, said) = here.run(&format!("embed in/model.gltf out/ {ADA} --tag A"));
    assert_eq!(code, 0, "{report} {said}");
    let names = [
        "buf/normals.bin",
        "buf/positions.bin",
        "in dices.bin",
        "textures/a#b.png",
    ];
    let written: Vec<&str> = ["model.gltf"].into_iter().chain(names).collect();
    assert_eq!(report["stored"]["written"], json!(written));
    assert_eq!(
        report["stored"]["missing"],
        json!(["../outside.png", "lost.png"])
    );
    for name in names {
        let [host, marked] =
            ["in", "out"].map(|folder| fs::read(here.path(folder).join(name)).unwrap());
        assert_eq!(host == marked, name != "buf/positions.bin", "{name}");
    }
    let (code, ..) = here.run(&format!("extract out/model.gltf {ADA}"));
    assert_eq!(code, 0);
    let (code, ..) = here.run(&format!(
        "note embed in/model.gltf -o noted/n.gltf {ADA} --text hello"
    ));
    assert_eq!(code, 0);
    assert!(here.path("noted/textures/a#b.png").exists());
}

#[test]
fn cli_leaves_no_half_model() {
    let here = Folder::new("half");
    write_gltf_of_many_files(&here);
    // A folder stands where a buffer has to go.
    fs::create_dir_all(here.path("out/buf/positions.bin/x")).unwrap();
    fs::write(here.path("out/in dices.bin"), "before").unwrap();
    let (code, ..) = here.run(&format!("embed in/model.gltf out/ {ADA} --tag A"));
    assert_eq!(code, 2);
    let left = |folder: &str| {
        let mut names: Vec<String> = fs::read_dir(here.path(folder))
            .unwrap()
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .collect();
        names.sort();
        names
    };
    assert_eq!(left("out"), ["buf", "in dices.bin"]);
    assert_eq!(left("out/buf"), ["positions.bin"]);
    assert_eq!(fs::read(here.path("out/in dices.bin")).unwrap(), b"before");
    // A file stands where a folder has to go.
    fs::write(here.path("file"), "").unwrap();
    let (code, ..) = here.run(&format!(
        "embed in/model.gltf file/deep/model.gltf {ADA} --tag A"
    ));
    assert_eq!(code, 2);
}

#[test]
fn cli_writes_over_the_input_only_when_asked() {
    let here = Folder::new("in-place");
    write_gltf_of_many_files(&here);
    let (code, _, said) = here.run(&format!("embed in/model.gltf in {ADA} --tag A"));
    assert_eq!(code, 2);
    assert!(said.contains("--in-place"), "{said}");
    let (code, _, said) = here.run(&format!("embed model.glb model.glb {ADA} --tag A"));
    assert_eq!(code, 2);
    assert!(said.contains("--in-place"), "{said}");
    let (code, ..) = here.run(&format!("extract in/model.gltf {ADA}"));
    assert_eq!(code, 1);
    let (code, report, said) = here.run(&format!("embed in/model.gltf --in-place {ADA} --tag A"));
    assert_eq!(code, 0, "{report} {said}");
    let (code, ..) = here.run(&format!("extract in/model.gltf {ADA}"));
    assert_eq!(code, 0);
}

#[test]
fn cli_writes_and_reads_a_note() {
    let here = Folder::new("note");
    let (code, report, said) = here.run(&format!(
        "note embed model.glb -o noted.glb {ADA} --text Kallisto"
    ));
    assert_eq!(code, 0, "{report} {said}");
    assert_eq!(
        (&report["text"], &report["size"]["bits"]),
        (&"Kallisto".into(), &64.into())
    );
    assert_eq!(report["capacity"]["characters"], 29);
    assert!(report["rmsRel"].as_f64().unwrap() < 0.001);
    assert_eq!(report["readBack"]["verdict"], "found");
    here.run(&format!("embed noted.glb marked.glb {ADA} --tag ADA-1"));
    let (code, report, _) = here.run(&format!("note read marked.glb {ADA}"));
    assert_eq!((code, &report["text"]), (0, &"Kallisto".into()));
    assert!(report["lnP"].as_f64().unwrap() < -100.0);
    let (code, report, _) = here.run(&format!("extract marked.glb {ADA}"));
    assert_eq!((code, &report["tag"]), (0, &"ADA-1".into()));

    let other = "--owner Ada --passphrase-file other.txt";
    let (code, report, _) = here.run(&format!("note read marked.glb {other}"));
    assert_eq!(
        (code, &report["verdict"], &report["text"]),
        (1, &"none".into(), &Value::Null)
    );
    let long = "x".repeat(30);
    let (code, report, _) = here.run(&format!(
        "note embed model.glb -o no.glb {ADA} --text {long}"
    ));
    assert_eq!(
        (code, &report["error"]["code"]),
        (2, &"text.too-long".into())
    );
    assert!(!here.path("no.glb").exists());
}

/// The seed paper's study of a small model: nothing is lost where nothing was smoothed, and what is blind and ranked is at chance.
#[test]
fn cli_reads_with_the_original_and_with_the_record() {
    let folder = Folder::new("informed");
    let (code, report, _) = folder.run(&format!(
        "embed model.glb marked.glb {ADA} --tag ADA-1 --record --date 2026-11-29"
    ));
    assert_eq!(code, 0, "{report}");
    let record = fs::read_to_string(folder.path("marked.meshmark.json")).unwrap();
    let record: Value = serde_json::from_str(&record).unwrap();
    assert_eq!(record["owner"], "Ada");
    assert_eq!(record["date"], "2026-11-29");
    assert_eq!(record["markedSha256"], report["markedSha256"]);
    let mut command = Command::new(env!("CARGO_BIN_EXE_meshmark"));
    let words = ["attack", "marked.glb", "copy.glb"];
    let steps = ["crop 30 %", "simplify 50 %"].map(|step| ["--step", step]);
    let cut = command
        .args(words)
        .args(steps.as_flattened())
        .current_dir(&folder.0);
    assert!(cut.output().unwrap().status.success());
    for with in ["--original model.glb", "--record marked.meshmark.json"] {
        let (code, answer, _) = folder.run(&format!("extract copy.glb {with} {ADA}"));
        assert_eq!(code, 0, "{with}: {answer}");
        assert_eq!(answer["tag"], "ADA-1", "{with}");
        assert_eq!(answer["shape"], "same", "{with}");
        assert_eq!(answer["witness"], "surface", "{with}");
        let verify = |tag: &str| format!("verify copy.glb {with} --tag {tag} {ADA}");
        assert_eq!(folder.run(&verify("ADA-1")).0, 0, "{with}");
        let (code, answer, _) = folder.run(&verify("ADA-2"));
        assert_eq!((code, &answer["tag"]), (1, &json!("ADA-1")), "{with}");
    }
    for (with, role) in [
        ("--original model.glb", "Original"),
        ("--record marked.meshmark.json", "Record"),
    ] {
        let stated = format!("extract copy.glb {with} --report report.html {ADA}");
        assert_eq!(folder.run(&stated).0, 0, "{with}");
        let report = fs::read_to_string(folder.path("report.html")).unwrap();
        for words in [
            "Your mark was found.",
            "The shape is the original",
            "data:image/png;base64,",
            "whoever holds the key can make an",
            "cut: ",
            role,
            with,
        ] {
            assert!(report.contains(words), "{with}: {words}");
        }
        // A record has few triangles: of the copy's own it says nothing.
        assert_eq!(report.contains("other triangles: "), role == "Original");
        let is_recorded = report.contains("what the record keeps of it");
        assert_eq!(is_recorded, role == "Record");
    }
    let (code, answer, _) = folder.run(&format!("extract model.glb --original model.glb {ADA}"));
    assert_eq!((code, &answer["shape"]), (1, &json!("same")), "{answer}");
    assert_eq!(answer["lnP"], Value::Null, "it follows the key");
    let other = "--owner Ada --passphrase-file other.txt";
    let (code, _, said) = folder.run(&format!(
        "extract copy.glb --record marked.meshmark.json {other}"
    ));
    assert_eq!(code, 2);
    assert!(said.contains("another key"), "{said}");
}

#[test]
fn cli_studies() {
    let here = Folder::new("study");
    let pebble = meshmark::internals::mesh::shapes::asteroid(30, 45);
    fs::write(
        here.path("pebble.glb"),
        meshmark::internals::scene::to_glb(&pebble),
    )
    .unwrap();
    let (code, report, said) = here.run("study pebble.glb --keys 1 --seed 3");
    assert_eq!(code, 0, "{report} {said}");
    assert_eq!(
        (&report["vertices"], &report["triangles"]),
        (&1352.into(), &2700.into())
    );
    let table = report["table1"].as_array().unwrap();
    assert_eq!(table.len(), 3);
    assert_eq!(table[0]["rules"][0]["random"]["mean"], 1352.0);
    assert_eq!(table[1]["numVertices"], 1352 + 2700 + 4050);
    let errors = report["figure5"]["againstSmoothing"].as_array().unwrap();
    let payload = |hosts: &str, finding: &str| {
        let mut here = errors.iter().filter(|errors| errors["iterations"] == 0);
        let errors = here.find(|errors| errors["hosts"] == hosts && errors["finding"] == finding);
        errors.unwrap()["payload"]["mean"].as_f64().unwrap()
    };
    assert_eq!(payload("collapse", "traced"), 0.0);
    assert_eq!(payload("all", "cells"), 0.0);
    assert!(payload("collapse", "ranked") > 0.25);
    assert!(report["figure5"]["againstStrength"][0]["strength"].is_number());

    let (code, again, _) = here.run("study pebble.glb --keys 1 --seed 3");
    assert_eq!(
        (code, &again["table1"], &again["figure5"]),
        (0, &report["table1"], &report["figure5"])
    );
    let (code, ..) = here.run("study pebble.glb --preparation crumple");
    assert_eq!(code, 2);
    let small = meshmark::internals::mesh::shapes::asteroid(8, 12);
    fs::write(
        here.path("small.glb"),
        meshmark::internals::scene::to_glb(&small),
    )
    .unwrap();
    let (code, report, _) = here.run("study small.glb");
    assert_eq!(
        (code, &report["error"]["code"]),
        (2, &"carrier.too-few-hosts".into())
    );
}

#[test]
fn cli_inspects_and_tries_capacity() {
    let here = Folder::new("inspect");
    let (code, report, _) = here.run("inspect model.glb");
    assert_eq!(
        (code, &report["triangles"], &report["container"]),
        (0, &24_000.into(), &"glb".into())
    );
    let (code, report, _) = here.run("capacity model.glb");
    assert_eq!(
        (code, &report["holds"], &report["strength"]),
        (0, &"payload".into(), &"balanced".into())
    );
}

#[test]
fn cli_says_what_is_wrong_and_writes_nothing() {
    let here = Folder::new("errors");
    fs::write(here.path("short.glb"), &meshmark::demo_model()[..5000]).unwrap();
    for (arguments, code) in [
        (
            format!("embed short.glb out.glb {ADA} --tag A"),
            "document.truncated",
        ),
        (
            format!("embed model.glb out.glb {ADA} --tag too-long-a-tag"),
            "payload.length",
        ),
        (format!("embed nowhere.glb out.glb {ADA} --tag A"), "io"),
        (
            format!("embed secret.txt out.glb {ADA} --tag A"),
            "document.bad-container",
        ),
        (
            "extract model.glb --owner Ada --passphrase-file nowhere.txt".to_owned(),
            "io",
        ),
    ] {
        let (exit, report, said) = here.run(&arguments);
        assert_eq!(
            (exit, &report["error"]["code"]),
            (2, &code.into()),
            "{arguments}: {report}"
        );
        assert!(said.starts_with("meshmark: "), "{said}");
        assert!(!said.contains("correct horse"));
    }
    assert!(!Path::new(&here.path("out.glb")).exists());
}

#[test]
fn cli_usage_errors_exit_with_2() {
    let here = Folder::new("usage");
    for arguments in [
        "",
        "embed",
        "extract model.glb --passphrase secret",
        "frobnicate",
    ] {
        let (code, _, said) = here.run(arguments);
        assert_eq!(code, 2, "{arguments}");
        assert!(said.contains("Usage"), "{said}");
    }
    let (code, _, said) = here.run("embed model.glb b --tag X");
    assert_eq!(code, 2);
    assert!(said.contains("--owner NAME or --key-file FILE"), "{said}");
}

#[test]
fn cli_reads_suspects_in_other_formats() {
    let here = Folder::new("formats");
    here.run(&format!("embed model.glb marked.glb {ADA} --tag ADA-1"));
    let marked = fs::read(here.path("marked.glb")).unwrap();
    let json_length = u32::from_le_bytes(marked[12..16].try_into().unwrap()) as usize;
    let json: Value = serde_json::from_slice(&marked[20..20 + json_length]).unwrap();
    let binary = &marked[20 + json_length + 8..];
    let view = |index: usize| {
        let view = &json["bufferViews"][index];
        let number = |name: &str| view[name].as_u64().unwrap_or(0) as usize;
        &binary[number("byteOffset")..][..number("byteLength")]
    };
    let numbers = |bytes: &[u8]| -> Vec<[u8; 4]> { bytes.as_chunks().0.to_vec() };
    // Millimetres, Z up, in text of six digits.
    let points: Vec<String> = numbers(view(0))
        .chunks(3)
        .map(|point| {
            let [x, y, z] = [0, 1, 2].map(|axis| 1000.0 * f32::from_le_bytes(point[axis]));
            format!("{x:.5e} {:.5e} {y:.5e}", -z)
        })
        .collect();
    let triangles: Vec<[usize; 3]> = numbers(view(2))
        .chunks(3)
        .map(|corners| [0, 1, 2].map(|place| u32::from_le_bytes(corners[place]) as usize))
        .collect();
    let lines = |lines: Vec<String>| lines.join("\n");
    let obj = format!(
        "# by nobody\n{}\n{}\n",
        lines(points.iter().map(|point| format!("v {point}")).collect()),
        lines(
            triangles
                .iter()
                .map(|[a, b, c]| format!("f {} {} {}", a + 1, b + 1, c + 1))
                .collect()
        ),
    );
    let facet = |[a, b, c]: &[usize; 3]| {
        let [a, b, c] = [a, b, c].map(|corner| &points[*corner]);
        format!(
            "facet normal 0 0 0\nouter loop\nvertex {a}\nvertex {b}\nvertex {c}\nendloop\nendfacet"
        )
    };
    let stl = format!(
        "solid\n{}\nendsolid\n",
        lines(triangles.iter().map(facet).collect())
    );
    let ply = format!(
        "ply\nformat ascii 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\nelement face {}\n\
         property list uchar int vertex_indices\nend_header\n{}\n{}\n",
        points.len(),
        triangles.len(),
        lines(points.clone()),
        lines(
            triangles
                .iter()
                .map(|[a, b, c]| format!("3 {a} {b} {c}"))
                .collect()
        ),
    );
    for (name, bytes) in [("obj", obj), ("stl", stl), ("ply", ply)] {
        // Names of files say little.
        fs::write(here.path("copy"), bytes).unwrap();
        let (code, report, said) = here.run(&format!("extract copy {ADA}"));
        assert_eq!(
            (code, &report["tag"]),
            (0, &json!("ADA-1")),
            "{name}: {said}"
        );
        let (code, ..) = here.run(&format!("verify copy {ADA} --tag ADA-1"));
        assert_eq!(code, 0, "{name}");
        here.run("measure copy copy.mmev");
        let (code, ..) = here.run(&format!("extract copy.mmev --evidence {ADA}"));
        assert_eq!(code, 0, "{name}");
        let (code, report, said) = here.run(&format!("embed copy no.glb {ADA} --tag A"));
        assert_eq!(
            (code, &report["error"]["code"]),
            (2, &json!("file.other-format"))
        );
        assert!(said.contains("glTF only"), "{said}");
    }
    fs::write(here.path("copy"), "Kaydara FBX Binary").unwrap();
    let (code, _, said) = here.run(&format!("extract copy {ADA}"));
    assert_eq!(code, 2);
    assert!(said.contains("FBX"), "{said}");
    fs::write(here.path("copy"), "v 0 0 0\nv 1 0 0\nf 1 2 3\n").unwrap();
    let (code, report, _) = here.run(&format!("extract copy {ADA}"));
    assert_eq!(
        (code, &report["error"]["code"]),
        (2, &json!("file.damaged"))
    );
}

/// A host that comes wrapped goes wrapped, and the report's digests are of the files on disk.
#[test]
fn cli_wraps_what_came_wrapped() {
    let here = Folder::new("wrapped");
    let gzip = |bytes: &[u8]| {
        let mut writer = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
        std::io::Write::write_all(&mut writer, bytes).unwrap();
        writer.finish().unwrap()
    };
    fs::write(here.path("model.glb.gz"), gzip(&meshmark::demo_model())).unwrap();
    let (code, report, said) = here.run(&format!("embed model.glb.gz marked.glb.gz {ADA} --tag A"));
    assert_eq!(code, 0, "{said}");
    let marked = fs::read(here.path("marked.glb.gz")).unwrap();
    assert_eq!(marked[..2], [0x1f, 0x8b]);
    for (name, digest) in [
        ("model.glb.gz", "hostSha256"),
        ("marked.glb.gz", "markedSha256"),
    ] {
        let bytes = fs::read(here.path(name)).unwrap();
        assert_eq!(
            report[digest],
            meshmark::internals::digest::sha256(&bytes),
            "{name}"
        );
    }
    let (code, ..) = here.run(&format!("extract marked.glb.gz {ADA}"));
    assert_eq!(code, 0);
    // Nothing is compressed here, so nothing is taken out.
    let (_, plain, _) = here.run(&format!("embed model.glb a.glb {ADA} --tag A"));
    let (_, same, _) = here.run(&format!("embed model.glb b.glb --decompress {ADA} --tag A"));
    assert_eq!(plain["markedSha256"], same["markedSha256"]);
}

#[test]
fn a_copy_for_each_buyer_is_traced_and_stated() {
    let folder = Folder::new("copies");
    let buyers = "name\n\"Grace, the first\"\n<script>alert(1)</script>\nLin\n";
    fs::write(folder.path("buyers.csv"), buyers).unwrap();
    let copies = format!("copies model.glb --ledger buyers.csv --out sold --date 2026-11-29 {ADA}");
    let (code, made, _) = folder.run(&copies);
    assert_eq!(code, 0);
    assert_eq!(made["copies"].as_array().unwrap().len(), 3);
    assert_eq!(made["copies"][1]["number"], 2);
    assert_eq!(made["copies"][1]["file"], "model.2.glb");
    assert_eq!(made["numWeaker"], 0);
    let sha256 = made["copies"][1]["markedSha256"].as_str().unwrap();
    let ledger = fs::read_to_string(folder.path("sold/ledger.csv")).unwrap();
    let triangles = made["copies"][1]["triangles"].as_u64().unwrap();
    let line = format!("2,<script>alert(1)</script>,model.2.glb,{sha256},2026-11-29,{triangles}");
    assert!(ledger.lines().any(|other| other == line), "{ledger}");
    assert!(ledger.contains("\"Grace, the first\""), "{ledger}");
    // A ledger is not written over.
    let (code, refused, _) = folder.run(&copies);
    assert_eq!(code, 2);
    assert!(
        refused["error"]["message"]
            .as_str()
            .unwrap()
            .contains("ledger.csv is there already")
    );

    let (code, _, _) = folder.run("attack sold/model.2.glb leaked.glb --step simplify.50");
    assert_eq!(code, 2, "steps have a blank");
    let mut command = Command::new(env!("CARGO_BIN_EXE_meshmark"));
    let attack = [
        "attack",
        "sold/model.2.glb",
        "leaked.glb",
        "--step",
        "simplify 50",
    ];
    assert!(
        command
            .args(attack)
            .current_dir(&folder.0)
            .output()
            .unwrap()
            .status
            .success()
    );
    for ledger in ["sold/ledger.csv", "sold/ledger.json"] {
        let trace =
            format!("trace leaked.glb --ledger {ledger} --report report.html --date today {ADA}");
        let (code, traced, _) = folder.run(&trace);
        assert_eq!(code, 0, "{traced}");
        assert_eq!(traced["traced"], "named");
        assert_eq!(traced["numBuyers"], 3);
        let buyers = traced["buyers"].as_array().unwrap();
        assert_eq!(buyers.len(), 1);
        assert_eq!(buyers[0]["number"], 2);
        assert_eq!(buyers[0]["name"], "<script>alert(1)</script>");
        assert!(buyers[0]["lnP"].as_f64().unwrap() < -20.8);
    }
    let report = fs::read_to_string(folder.path("report.html")).unwrap();
    assert!(
        report.contains("<bdi>Ledger</bdi>"),
        "the ledger's digest is a fact too"
    );
    assert!(report.contains("&lt;script&gt;alert(1)&lt;/script&gt;"));
    assert!(report.contains("What this does not prove"));
    assert!(report.contains("--ledger sold/ledger.json --owner &quot;Ada&quot;"));
    assert!(report.contains("today"));
    for active in [
        "<script", "<img", "<link", "http://", "https://", "src=", "url(",
    ] {
        assert!(!report.contains(active), "{active}");
    }
    assert!(!report.contains("correct horse"));
    let ledger = fs::read(folder.path("sold/ledger.json")).unwrap();
    assert!(
        report.contains(&meshmark::internals::digest::sha256(&ledger)),
        "the digest of the ledger"
    );
    assert!(report.contains("50 % of the"), "by the ledger's triangles");
    assert!(report.contains("more is not known without the original"));
    // A list without triangles says less.
    let trace = format!("trace leaked.glb --ledger buyers.csv --report report.html {ADA}");
    assert_eq!(folder.run(&trace).0, 0);
    let report = fs::read_to_string(folder.path("report.html")).unwrap();
    assert!(report.contains("<bdi>Not known: "));

    // With the original the report has its picture, and says what was done.
    let trace = format!(
        "trace leaked.glb --ledger sold/ledger.csv --original model.glb --report report.html {ADA}"
    );
    let (code, traced, _) = folder.run(&trace);
    assert_eq!(code, 0, "{traced}");
    assert_eq!(traced["buyers"][0]["number"], 2);
    assert_eq!(traced["comparison"]["shape"], "same");
    let report = fs::read_to_string(folder.path("report.html")).unwrap();
    for words in [
        "--ledger sold/ledger.csv --original model.glb --owner",
        "<bdi>Original</bdi>",
        "data:image/png;base64,",
        "other triangles: 50 %",
        "Show that it is older.",
    ] {
        assert!(report.contains(words), "{words}");
    }

    // Of another key's marks nothing is said.
    let other = "trace leaked.glb --ledger sold/ledger.csv --owner Ada --passphrase-file other.txt";
    let (code, traced, _) = folder.run(other);
    assert_eq!(code, 1);
    assert_eq!(traced["traced"], "no-mark");
    assert_eq!(traced["buyers"], json!([]));
}

#[test]
fn ledgers_that_cannot_be_meant_are_refused() {
    let folder = Folder::new("ledgers");
    for (content, words) in [
        ("Grace\nLin\n", "has to name its columns"),
        ("number,name\n1,Grace\n1,Lin\n", "there twice"),
        ("number,name\n1,Grace\n,Lin\n", "has no number"),
        ("number\n-1\n", "damaged"),
        ("number\n", "nobody is in it"),
    ] {
        fs::write(folder.path("buyers.csv"), content).unwrap();
        let (code, refused, _) = folder.run(&format!("trace model.glb --ledger buyers.csv {ADA}"));
        assert_eq!(code, 2);
        let message = refused["error"]["message"].as_str().unwrap();
        assert!(message.contains(words), "{content:?}: {message}");
    }
}

#[test]
fn a_reading_is_stated_too() {
    let folder = Folder::new("statement");
    let (code, _, _) = folder.run(&format!("embed model.glb marked.glb --tag ADA-1 {ADA}"));
    assert_eq!(code, 0);
    let extract = format!("extract marked.glb --report report.html {ADA}");
    assert_eq!(folder.run(&extract).0, 0);
    let report = fs::read_to_string(folder.path("report.html")).unwrap();
    for words in [
        "Your mark was found.",
        "ADA-1",
        "marked.glb",
        "less than 1 in 10^38",
    ] {
        assert!(report.contains(words), "{words}");
    }
    assert_eq!(
        folder
            .run(&format!("extract model.glb --report none.html {ADA}"))
            .0,
        1
    );
    let report = fs::read_to_string(folder.path("none.html")).unwrap();
    assert!(report.contains("No evidence of this key."));
    assert!(!report.contains("1 in 10"), "a number that follows the key");
}
