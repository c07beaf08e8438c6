//! The command line.

use crate::mesh::MADE;
use crate::peers::{PEERS, Peer};
use crate::rays::Kind;

pub const HELP: &str = "\
Measures ray kernels on the same rays: bench-kernels [OPTIONS] [FILE.obj|FILE.ply ...]
  --embree PATH     Embree 4's shared library; without it only the other peers run
  --mesh LIST       sphere, terrain, hall [default: all, or none if files are given]
  --size LIST       triangles [default: 100000]
  --kinds LIST      primary, shadow, bounce, ao [default: all]
  --peers LIST      see --list [default: umbriel,umbriel-high,embree-robust,embree]
  --passes N        timed rounds [default: 5]
  --threads LIST    [default: 1]; builds use the first
  --builds N        builds to take medians of [default: 1; with --build-only 3]
  --build-only      builds only
  --side N          pixels a side of the picture, a power of two [default: 1024]
  --picture PREFIX  writes PREFIX-MESH.pgm: light and occlusion as the reference sees them
  --json            one JSON object a row
  --list            names of the peers";

/// What is asked for.
pub struct Args {
    pub embree: Option<String>,
    pub meshes: Vec<String>,
    pub sizes: Vec<usize>,
    pub files: Vec<String>,
    pub kinds: Vec<(&'static str, Kind)>,
    pub peers: Vec<Peer>,
    pub passes: usize,
    pub threads: Vec<usize>,
    pub builds: usize,
    pub build_only: bool,
    pub side: u32,
    pub picture: Option<String>,
    pub json: bool,
}

fn find<T: Copy>(all: &[T], name: impl Fn(&T) -> &'static str, list: &str) -> Result<Vec<T>, String> {
    let names = || all.iter().map(&name).collect::<Vec<_>>().join(", ");
    let one = |word: &str| all.iter().copied().find(|x| name(x) == word);
    list.split(',').map(|word| one(word).ok_or_else(|| format!("no `{word}`; expected: {}", names()))).collect()
}

fn numbers(list: &str) -> Result<Vec<usize>, String> {
    let one = |word: &str| word.parse().ok().filter(|&n| n > 0).ok_or_else(|| format!("bad number `{word}`"));
    list.split(',').map(one).collect()
}

impl Args {
    /// Reads the words after the program's name.
    pub fn parse(mut words: impl Iterator<Item = String>) -> Result<Self, String> {
        let (mut args, mut meshes, mut builds) = (Self::defaults()?, None, None);
        while let Some(word) = words.next() {
            let mut value = || words.next().ok_or_else(|| format!("{word} needs a value"));
            match word.as_str() {
                "--embree" => args.embree = Some(value()?),
                "--mesh" => meshes = Some(find(&MADE, |name| name, &value()?)?),
                "--size" => args.sizes = numbers(&value()?)?,
                "--kinds" => args.kinds = find(&Kind::ALL, |kind| kind.0, &value()?)?,
                "--peers" => args.peers = find(PEERS, |peer| peer.name, &value()?)?,
                "--passes" => args.passes = numbers(&value()?)?[0],
                "--threads" => args.threads = numbers(&value()?)?,
                "--builds" => builds = Some(numbers(&value()?)?[0]),
                "--side" => args.side = (numbers(&value()?)?[0] as u32).next_power_of_two().min(4096),
                "--picture" => args.picture = Some(value()?),
                "--build-only" => args.build_only = true,
                "--json" => args.json = true,
                _ if word.starts_with('-') => return Err(format!("no option `{word}`\n{HELP}")),
                _ => args.files.push(word),
            }
        }
        let made: &[&str] = if args.files.is_empty() { &MADE } else { &[] };
        args.meshes = meshes.unwrap_or(made.to_vec()).into_iter().map(String::from).collect();
        args.builds = builds.unwrap_or(if args.build_only { 3 } else { 1 });
        Ok(args)
    }

    fn defaults() -> Result<Self, String> {
        Ok(Self {
            embree: None,
            meshes: Vec::new(),
            sizes: vec![100_000],
            files: Vec::new(),
            kinds: Kind::ALL.to_vec(),
            peers: find(PEERS, |peer| peer.name, "umbriel,umbriel-high,embree-robust,embree")?,
            passes: 5,
            threads: vec![1],
            builds: 1,
            build_only: false,
            side: 1024,
            picture: None,
            json: false,
        })
    }
}
