//! The public items of the crate: listed in `public-api.txt`, documented, and used in a doc test.
//!
//! `BLESS=1 cargo test -p fieldline-planner --test public_api` rewrites the list. A change of it is
//! a change for users: review it, and say it in CHANGELOG.md.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

use quote::ToTokens;
use syn::{Attribute, Fields, ImplItem, Item, TraitItem, UseTree, Visibility};

/// Returns the Rust files below a folder.
fn files(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).expect("the crate's sources") {
        let path = entry.expect("readable").path();
        if path.is_dir() {
            found.extend(files(&path));
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            found.push(path);
        }
    }
    found.sort();
    found
}

/// Returns the names that the crate's root re-exports.
fn roots(tree: &UseTree, names: &mut BTreeSet<String>) {
    match tree {
        UseTree::Path(path) => roots(&path.tree, names),
        UseTree::Group(group) => group.items.iter().for_each(|item| roots(item, names)),
        UseTree::Name(name) => drop(names.insert(name.ident.to_string())),
        UseTree::Rename(name) => drop(names.insert(name.ident.to_string())),
        UseTree::Glob(_) => panic!("the root names what it re-exports"),
    }
}

/// Returns the text of the doc comments.
fn doc(attributes: &[Attribute]) -> String {
    let texts = attributes.iter().filter_map(|attribute| {
        let is_doc = attribute.path().is_ident("doc");
        let meta = attribute
            .meta
            .require_name_value()
            .ok()
            .filter(|_| is_doc)?;
        Some(
            meta.value
                .to_token_stream()
                .to_string()
                .trim_matches('"')
                .to_owned(),
        )
    });
    texts.collect::<Vec<_>>().join("\n")
}

/// Returns tokens as text, with spaces as a person sets them.
fn text(tokens: impl ToTokens) -> String {
    let mut text = tokens.to_token_stream().to_string();
    for (from, to) in [
        (" :: ", "::"),
        (" < ", "<"),
        (" >", ">"),
        ("& ", "&"),
        (" ,", ","),
        (" : ", ": "),
        ("( ", "("),
        (" )", ")"),
        (" (", "("),
        (" ;", ";"),
        ("' ", "'"),
        ("->", "-> "),
        ("->  ", "-> "),
        ("[ ", "["),
        (" ]", "]"),
    ] {
        text = text.replace(from, to);
    }
    text
}

fn is_public(visibility: &Visibility) -> bool {
    matches!(visibility, Visibility::Public(_))
}

/// The public items: a line of text, and the documentation.
#[derive(Default)]
struct Api(BTreeMap<String, String>);

impl Api {
    fn add(&mut self, line: String, attributes: &[Attribute]) {
        self.0.insert(line, doc(attributes));
    }

    fn add_item(&mut self, item: &Item, names: &BTreeSet<String>) {
        let is_root = |name: &syn::Ident| names.contains(&name.to_string());
        match item {
            Item::Struct(item) if is_public(&item.vis) && is_root(&item.ident) => {
                let name = &item.ident;
                self.add(format!("struct {name}"), &item.attrs);
                if let Fields::Named(fields) = &item.fields {
                    for field in fields.named.iter().filter(|field| is_public(&field.vis)) {
                        let (ident, of) = (text(&field.ident), text(&field.ty));
                        self.add(format!("{name}::{ident}: {of}"), &field.attrs);
                    }
                }
            }
            Item::Enum(item) if is_public(&item.vis) && is_root(&item.ident) => {
                let name = &item.ident;
                self.add(format!("enum {name}"), &item.attrs);
                for variant in &item.variants {
                    let mut fields = variant.fields.clone();
                    for field in &mut fields {
                        field.attrs.clear();
                    }
                    let fields = text(&fields);
                    let line = format!("{name}::{}{fields}", variant.ident);
                    self.add(line, &variant.attrs);
                }
            }
            Item::Trait(item) if is_public(&item.vis) && is_root(&item.ident) => {
                let name = &item.ident;
                self.add(format!("trait {name}"), &item.attrs);
                for item in &item.items {
                    if let TraitItem::Fn(item) = item {
                        self.add(format!("{name}::{}", text(&item.sig)), &item.attrs);
                    }
                }
            }
            Item::Type(item) if is_public(&item.vis) && is_root(&item.ident) => {
                let line = format!("type {} = {}", item.ident, text(&item.ty));
                self.add(line, &item.attrs);
            }
            Item::Const(item) if is_public(&item.vis) && is_root(&item.ident) => {
                let line = format!("const {}: {}", item.ident, text(&item.ty));
                self.add(line, &item.attrs);
            }
            Item::Fn(item) if is_public(&item.vis) && is_root(&item.sig.ident) => {
                self.add(text(&item.sig), &item.attrs);
            }
            Item::Impl(item) if item.trait_.is_none() => self.add_methods(item, names),
            _ => {}
        }
    }

    fn add_methods(&mut self, block: &syn::ItemImpl, names: &BTreeSet<String>) {
        let of = text(&block.self_ty);
        let name = of.split('<').next().unwrap_or_default();
        if !names.contains(name) {
            return;
        }
        for item in &block.items {
            match item {
                ImplItem::Fn(item) if is_public(&item.vis) => {
                    self.add(format!("{name}::{}", text(&item.sig)), &item.attrs);
                }
                ImplItem::Const(item) if is_public(&item.vis) => {
                    let line = format!("{name}::{}: {}", item.ident, text(&item.ty));
                    self.add(line, &item.attrs);
                }
                _ => {}
            }
        }
    }
}

/// Returns the re-exported names and the public items.
fn api() -> (BTreeSet<String>, Api) {
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let parse = |path: &Path| {
        let text = fs::read_to_string(path).expect("readable");
        syn::parse_file(&text).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
    };
    let mut names = BTreeSet::new();
    for item in &parse(&source.join("lib.rs")).items {
        if let Item::Use(item) = item
            && is_public(&item.vis)
        {
            roots(&item.tree, &mut names);
        }
    }
    let mut api = Api::default();
    for path in files(&source) {
        for item in &parse(&path).items {
            api.add_item(item, &names);
        }
    }
    (names, api)
}

#[test]
fn the_public_items_are_listed() {
    let (_, api) = api();
    let lines: Vec<&str> = api.0.keys().map(String::as_str).collect();
    let found = lines.join("\n") + "\n";
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("public-api.txt");
    if std::env::var_os("BLESS").is_some() {
        fs::write(&path, &found).expect("writable");
    }
    let listed = fs::read_to_string(&path).unwrap_or_default();
    let (old, new): (BTreeSet<&str>, BTreeSet<&str>) =
        (listed.lines().collect(), found.lines().collect());
    let gone: Vec<_> = old.difference(&new).collect();
    let added: Vec<_> = new.difference(&old).collect();
    assert!(
        gone.is_empty() && added.is_empty(),
        "the public items changed\ngone: {gone:#?}\nadded: {added:#?}\n\
         If that is meant, run BLESS=1 cargo test -p fieldline-planner --test public_api"
    );
}

#[test]
fn every_public_item_is_documented() {
    let (_, api) = api();
    let bare: Vec<&String> = api
        .0
        .iter()
        .filter(|(_, doc)| doc.trim().is_empty())
        .map(|(line, _)| line)
        .collect();
    assert!(bare.is_empty(), "without documentation: {bare:#?}");
}

/// A number has its unit in its name or in its documentation.
#[test]
fn every_public_number_has_a_unit() {
    const SUFFIXES: [&str; 8] = ["_m", "_mm", "_s", "_ms", "_rad", "_mps", "_radps", "_mps2"];
    const WORDS: [&str; 13] = [
        "metre",
        "radian",
        "second",
        "cell",
        "tile",
        "number",
        "in its unit",
        "Number",
        "tangent",
        "Unit:",
        "factor",
        "per metre",
        "least preference",
    ];
    let (_, api) = api();
    let is_number = |line: &str| {
        let of = line.split_once(": ").filter(|_| !line.contains('('));
        of.is_some_and(|(_, of)| ["f32", "u8", "u16", "u32", "i32", "usize"].contains(&of))
    };
    let bare: Vec<&String> = api
        .0
        .iter()
        .filter(|(line, doc)| {
            let name = line.split(':').rev().nth(1).unwrap_or_default();
            is_number(line)
                && !SUFFIXES.iter().any(|suffix| name.ends_with(suffix))
                && !WORDS.iter().any(|word| doc.contains(word))
        })
        .map(|(line, _)| line)
        .collect();
    assert!(bare.is_empty(), "without a unit: {bare:#?}");
}

#[test]
fn every_re_exported_name_is_used_in_a_doc_test() {
    let (names, _) = api();
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut code = String::new();
    let mut sources = files(&root.join("src"));
    sources.push(root.join("README.md"));
    for path in sources {
        let is_page = path.extension().is_some_and(|extension| extension == "md");
        let text = fs::read_to_string(&path).expect("readable");
        let mut inside = false;
        for line in text.lines() {
            let line = line.trim_start();
            let comment = line.strip_prefix("///").or(line.strip_prefix("//!"));
            let Some(line) = comment.or(is_page.then_some(line)) else {
                continue;
            };
            if line.trim_start().starts_with("```") {
                inside = !inside;
            } else if inside {
                code.push_str(line);
                code.push('\n');
            }
        }
    }
    let words: BTreeSet<&str> = code
        .split(|c: char| !c.is_alphanumeric() && c != '_')
        .collect();
    let unused: Vec<&String> = names
        .iter()
        // The rooms' structs are fields of `Tuning`, which is in a doc test.
        .filter(|name| !name.ends_with("Tuning") && !words.contains(name.as_str()))
        .collect();
    assert!(unused.is_empty(), "in no doc test: {unused:#?}");
}
