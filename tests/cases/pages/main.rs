//! Figures of the pages: each stands in a golden file, or a comment says what else it is. Links of
//! the pages: each leads somewhere.
//!
//! | module | content |
//! | --- | --- |
//! | [`section`] | a page, and the comments about its figures |
//! | [`figures`] | numbers, and what makes them golden |
//! | `links` | links from page to page |
//!
//! A page that is not in [`PAGES`] is not under the rule.

mod figures;
mod links;
mod section;

use std::fs;
use std::path::Path;

use fieldline_tests::golden;
use figures::{Figure, evaluated, figures, numbers};
use section::{Section, sections};

/// Pages under the rule, and how many of their figures nothing checks: those that were counted by
/// hand or made once. The number may only fall.
const PAGES: [(&str, usize); 3] = [
    ("README.md", 1),
    ("docs/PAPERS.md", 8),
    ("docs/RESULTS.md", 212),
];

#[test]
fn every_figure_of_a_page_is_in_a_golden_file() {
    let mut faults = Vec::new();
    for (page, most) in PAGES {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(page);
        let text = match fs::read_to_string(&path) {
            Ok(text) => text,
            Err(error) => panic!("{}: {error}", path.display()),
        };
        let mut unchecked = 0;
        for section in sections(&text) {
            unchecked += numbers(&section.once).len() + numbers(&section.counted).len();
            let of = section.faults();
            faults.extend(
                of.iter()
                    .map(|it| format!("{page}, {}: {it}", section.title)),
            );
        }
        if unchecked != most {
            faults.push(format!(
                "{page}: {unchecked} figures that nothing checks, not {most}"
            ));
        }
    }
    assert!(
        faults.is_empty(),
        "CONTRIBUTING.md says what to do:\n{}",
        faults.join("\n")
    );
}

impl Section {
    /// Returns what is wrong with the figures of a section.
    fn faults(&self) -> Vec<String> {
        let mut faults = Vec::new();
        let golden: Vec<Figure> = self
            .goldens
            .iter()
            .flat_map(|it| golden_numbers(it))
            .collect();
        let mut allowed: Vec<Figure> = [&self.given, &self.counted, &self.once]
            .into_iter()
            .flat_map(|it| numbers(it))
            .collect();
        for (text, terms) in &self.derived {
            let figure = numbers(text).into_iter().next();
            let value = evaluated(terms, &golden);
            match figure.clone().zip(value.clone().ok()) {
                Some((figure, value)) if figure.rounds(value) => allowed.push(figure),
                _ => faults.push(format!("{text} is not {terms}: {value:?}")),
            }
        }
        let found = figures(&self.prose);
        let listed = |it: &Figure| allowed.iter().any(|other| other.text == it.text);
        let missing = found
            .iter()
            .filter(|it| !listed(it) && !it.is_among(&golden));
        faults.extend(missing.map(|it| format!("{} is in none of {:?}", it.text, self.goldens)));
        let idle = allowed.iter().filter(|it| {
            !numbers(&self.prose)
                .iter()
                .any(|other| other.text == it.text)
        });
        faults.extend(idle.map(|it| format!("{} is in a comment, and not in the text", it.text)));
        faults
    }
}

/// Returns the numbers of a golden file.
fn golden_numbers(name: &str) -> Vec<Figure> {
    match fs::read_to_string(golden::path(name)) {
        Ok(text) => numbers(&text),
        Err(error) => panic!("golden file {name}: {error}"),
    }
}

/// Returns the faults of a page with one section.
fn faults_of(page: &str) -> Vec<String> {
    sections(page).iter().flat_map(Section::faults).collect()
}

#[test]
fn a_figure_that_no_golden_file_has_is_a_fault() {
    let link = "[size.txt](../tests/golden/size.txt)";
    let none: [String; 0] = [];
    let text = |text: &str| faults_of(&format!("# Head 77\n\n{link}: {text}\n"));
    assert_eq!(
        text("a stack of 16384 bytes, 16 KB, and 16,384 again"),
        none
    );
    assert_eq!(text("a stack of 16,385 bytes").len(), 1);
    assert_eq!(text("a stack of 17 KB").len(), 1);
    assert_eq!(
        text("an STM32F405, `x 77`, [Jorge15, Fig. 77], [a](b77), 7 times"),
        none
    );
    assert_eq!(text("7 % and 0.7").len(), 2);
}

#[test]
fn comments_cover_their_figures_and_no_others() {
    let none: [String; 0] = [];
    assert_eq!(faults_of("<!-- given: 20 m -->\nAt 20 m.\n"), none);
    assert_eq!(
        faults_of("<!-- once: 20 -->\nAt 30 m.\n").len(),
        2,
        "one missing, one idle"
    );
    let derived = "<!-- golden: size.txt --> <!-- derived: 25 = 16384 / 65536 * 100 -->\n25 %.\n";
    assert_eq!(faults_of(&derived.replace("65536", "16384")).len(), 2);
    let quarter = derived.replace("65536", "64240").replace("25", "26");
    assert_eq!(faults_of(&quarter), none);
    assert_eq!(
        faults_of("# A\n<!-- given: 20 -->\n20\n# B\n20 m\n").len(),
        1,
        "of its section"
    );
}
