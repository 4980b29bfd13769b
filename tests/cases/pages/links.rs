//! Links from page to page: the file is there, and so is the heading.
//!
//! A heading's name in a link is GitHub's: lower case, without its marks, spaces as hyphens; the
//! second one of a name gets `-1`.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Component, Path, PathBuf};

/// Folders without pages of ours.
const LEFT_OUT: [&str; 3] = ["target", ".git", "out"];

#[test]
fn every_link_leads_to_a_page_and_a_heading() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let mut pages = BTreeMap::new();
    read_pages(&root, Path::new(""), &mut pages);
    assert!(pages.len() > 15, "{} pages", pages.len());
    let mut faults = Vec::new();
    let mut count = 0;
    for (page, text) in &pages {
        for link in links(text) {
            count += 1;
            if let Some(fault) = fault(&root, &pages, page, &link) {
                faults.push(format!("{}: {link}: {fault}", page.display()));
            }
        }
    }
    assert!(count > 200, "{count} links");
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

/// Reads the pages below a folder, by their path from the root.
fn read_pages(root: &Path, folder: &Path, pages: &mut BTreeMap<PathBuf, String>) {
    let entries = fs::read_dir(root.join(folder)).expect("a folder");
    for entry in entries.map(|entry| entry.expect("an entry")) {
        let name = entry.file_name();
        let path = folder.join(&name);
        let is_folder = entry.file_type().expect("a kind").is_dir();
        let is_hidden = name.to_string_lossy().starts_with('.');
        if is_folder && !is_hidden && !LEFT_OUT.iter().any(|it| name == *it) {
            read_pages(root, &path, pages);
        } else if !is_folder && path.extension().is_some_and(|it| it == "md") {
            let text = fs::read_to_string(entry.path()).expect("a page");
            pages.insert(path, text);
        }
    }
}

/// Returns the lines of a page outside of code.
fn prose(text: &str) -> impl Iterator<Item = &str> {
    let mut is_code = false;
    text.lines().filter(move |line| {
        let is_fence = line.trim_start().starts_with("```");
        is_code ^= is_fence;
        !is_code && !is_fence
    })
}

/// Returns where the links of a page lead, but for those out of the project.
fn links(text: &str) -> Vec<String> {
    let mut links = Vec::new();
    for line in prose(text) {
        // Every second part is code.
        let words: String = line.split('`').step_by(2).collect();
        let targets = words.split("](").skip(1);
        let targets = targets.filter_map(|rest| rest.split_once(')'));
        links.extend(targets.map(|(target, _)| target.to_owned()));
    }
    links.retain(|target| !target.contains("://") && !target.starts_with("mailto:"));
    links
}

/// Returns what is wrong with a link of a page.
fn fault(
    root: &Path,
    pages: &BTreeMap<PathBuf, String>,
    page: &Path,
    link: &str,
) -> Option<&'static str> {
    let (file, heading) = link.split_once('#').unwrap_or((link, ""));
    let file = match file {
        "" => page.to_owned(),
        file => plain(&page.parent()?.join(file)),
    };
    if !root.join(&file).exists() {
        return Some("there is no such file");
    }
    if heading.is_empty() {
        return None;
    }
    let names = headings(pages.get(&file)?);
    (!names.contains(heading)).then_some("the page has no such heading")
}

/// Returns a path without `..`.
fn plain(path: &Path) -> PathBuf {
    let mut plain = PathBuf::new();
    for part in path.components() {
        match part {
            Component::ParentDir => {
                plain.pop();
            }
            Component::CurDir => {}
            part => plain.push(part),
        }
    }
    plain
}

/// Returns the names of a page's headings.
fn headings(text: &str) -> BTreeSet<String> {
    let mut names = BTreeSet::new();
    for line in prose(text).filter(|line| line.starts_with('#')) {
        let name = name(line.trim_start_matches('#').trim());
        let again = (1..).map(|k| format!("{name}-{k}"));
        let free = core::iter::once(name.clone()).chain(again);
        let free = free.into_iter().find(|it| !names.contains(it));
        names.extend(free);
    }
    names
}

/// Returns the name of a heading.
fn name(heading: &str) -> String {
    let mut rest = heading;
    let mut words = String::new();
    // A link in a heading counts by its words.
    while let Some((before, link)) = rest.split_once('[') {
        let (shown, after) = link.split_once("](").unwrap_or((link, ""));
        words += before;
        words += shown;
        rest = after.split_once(')').map_or("", |(_, after)| after);
    }
    words += rest;
    let kept = words.to_lowercase();
    let kept = kept.chars().filter_map(|mark| match mark {
        ' ' => Some('-'),
        '-' | '_' => Some(mark),
        mark => mark.is_alphanumeric().then_some(mark),
    });
    kept.collect()
}

#[test]
fn names_and_faults_are_those_of_github() {
    let page = "# Let it run: `run`, and [more](a.md)\n## Again\n## Again\n```\n# code\n```\n";
    let names = headings(page);
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    assert_eq!(names, ["again", "again-1", "let-it-run-run-and-more"]);

    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let pages = BTreeMap::from([(PathBuf::from("README.md"), page.to_owned())]);
    let at = Path::new("golden/page.md");
    let fault = |link| fault(root, &pages, at, link);
    assert_eq!(fault("../README.md#again-1"), None);
    assert_eq!(fault("../README.md"), None);
    assert!(fault("../README.md#code").is_some_and(|it| it.contains("heading")));
    assert!(fault("README.md").is_some_and(|it| it.contains("file")));
    assert_eq!(links("[a](b.md#c) `[d](e)` [f](https://g)"), ["b.md#c"]);
}
