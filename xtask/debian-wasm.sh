#!/bin/sh
# Makes Debian's Rust compiler fit for wasm. It knows the target but has no standard library for it, so that is built here, once,
# from Debian's source. It goes with links to the rest of the compiler into FOLDER; wasm commands have FOLDER/bin first on PATH.
#
# usage: debian-wasm.sh FOLDER TARGET_DIR    TARGET_DIR: what was compiled with another standard library goes
set -eu
folder=$1 target_dir=$2
target=wasm32-unknown-unknown
here=$(cd "$(dirname "$0")" && pwd)
"$here/apt-install.sh" rustc-web cargo-web rust-web-src rust-web-clippy
sysroot=$(rustc --print sysroot)

# What rustup's cargo sets for its own compiler.
unset CARGO LD_LIBRARY_PATH RUSTUP_TOOLCHAIN RUSTC RUSTFLAGS
host=$(/usr/bin/rustc -vV | sed -n 's/^host: //p')
linker=$sysroot/lib/rustlib/$host/bin/rust-lld # which every rustup toolchain brings
if [ ! -f "$linker" ]; then
  echo "there is no linker at $linker"
  exit 1
fi

made_from=$(echo "$folder $linker" && /usr/bin/rustc -vV && cat "$here/debian-wasm.sh")
# What was compiled with another standard library is of no use with this one.
if [ "$made_from" != "$(cat "$target_dir/made-with" 2> /dev/null)" ]; then
  rm -rf "$target_dir"
  mkdir -p "$target_dir"
  printf '%s\n' "$made_from" > "$target_dir/made-with" # echo of some shells reads backslashes
fi

# Every checkout has the folder: one makes it, the others wait.
mkdir -p "$(dirname "$folder")"
exec 9> "$folder.lock"
flock 9
if [ "$made_from" = "$(cat "$folder/made-from" 2> /dev/null)" ]; then
  echo "$folder has $target"
  exit
fi

# The standard library, as a dependency of an empty crate.
rustlib=$folder/lib/rustlib
rm -rf "$folder"
mkdir -p "$folder/std/src" "$folder/bin" "$rustlib/$target/lib" "$rustlib/$host/bin"
cd "$folder/std"
echo '#![no_std]' > src/lib.rs
cat > Cargo.toml <<'MANIFEST'
[package]
name = "scratch"
edition = "2024"

[workspace]

[profile.release]
codegen-units = 1
panic = "abort"
MANIFEST
# RUSTC_BOOTSTRAP lets a stable compiler take -Z; the bitcode is there so that link-time optimisation reaches into the library.
RUSTC=/usr/bin/rustc RUSTC_BOOTSTRAP=1 CARGO_ENCODED_RUSTFLAGS=-Cembed-bitcode=yes CARGO_TARGET_DIR=target \
  /usr/bin/cargo build --quiet --release --target $target -Zbuild-std=std,panic_abort,panic_unwind,proc_macro,test
rm target/$target/release/deps/libscratch*
mv target/$target/release/deps/*.rlib "$rustlib/$target/lib"
cd "$folder"
rm -r std

ln -s "$linker" "$rustlib/$host/bin/rust-lld"
ln -s "/usr/lib/rustlib/$host/lib" "$rustlib/$host/lib"
ln -s /usr/lib/rustlib/src "$rustlib/src"
ln -s /usr/bin/cargo bin/cargo
cp /usr/bin/cargo-clippy bin # a copy: it looks for clippy-driver beside itself
for tool in rustc rustdoc clippy-driver; do
  printf '#!/bin/sh\nexec /usr/bin/%s "$@" --sysroot '"'%s'"'\n' $tool "$folder" > bin/$tool
  chmod +x bin/$tool
done
printf '%s\n' "$made_from" > made-from
