//! A page of prose, cut into sections at its headings, and what comments say of their figures.
//!
//! | comment | meaning, for the section that it is in |
//! | --- | --- |
//! | `<!-- golden: a.txt, b.txt -->` | golden files beside those that the section links |
//! | `<!-- given: 20 m, 15° -->` | figures that nobody measured here: parameters, papers, formats |
//! | `<!-- derived: 43 = 267.7 / 187.4 - 1 * 100 -->` | from left to right, of golden figures |
//! | `<!-- counted: 944 -->` | a count or a mean over rows of these files, made by hand |
//! | `<!-- once: 5.2 -->` | made by the command beside it, and in no golden file |
//!
//! Figures of code, of headings, of links' targets, of citations such as `[Jorge15, eq. 3]` and of
//! tables between `<!-- NAME -->` and `<!-- /NAME -->` are no prose. Another test compares those
//! tables.

/// A part of a page, from a heading to the next one.
#[derive(Debug, Default)]
pub(crate) struct Section {
    /// The heading.
    pub(crate) title: String,
    /// The prose: no code, no comment.
    pub(crate) prose: String,
    /// Names of its golden files.
    pub(crate) goldens: Vec<String>,
    /// Texts of its comments.
    pub(crate) given: String,
    pub(crate) counted: String,
    pub(crate) once: String,
    pub(crate) derived: Vec<(String, String)>,
}

/// Returns the sections of a page.
pub(crate) fn sections(page: &str) -> Vec<Section> {
    let mut sections = vec![Section::default()];
    let mut is_code = false;
    let mut bodies = vec![String::new()];
    for line in page.lines() {
        if line.trim_start().starts_with("```") {
            is_code = !is_code;
        } else if !is_code && line.starts_with('#') {
            sections.push(Section {
                title: line.trim_matches(['#', ' ']).into(),
                ..Section::default()
            });
            bodies.push(String::new());
        } else if !is_code && let Some(body) = bodies.last_mut() {
            body.push_str(line);
            body.push('\n');
        }
    }
    for (section, body) in sections.iter_mut().zip(&bodies) {
        section.goldens.extend(linked(body));
        let body = section.comments(body);
        section.prose = prose(&body);
    }
    sections
}

impl Section {
    /// Takes the comments out of a body, and keeps what they say.
    fn comments(&mut self, body: &str) -> String {
        let mut text = String::new();
        let mut rest = body;
        while let Some((before, comment, after)) = between(rest, "<!--", "-->") {
            text.push_str(before);
            let comment = comment.split_whitespace().collect::<Vec<_>>().join(" ");
            let end = format!("<!-- /{comment} -->");
            rest = match comment.split_once(": ") {
                Some((key, value)) => {
                    self.note(key, value);
                    after
                }
                None => after.split_once(&end).map_or(after, |(_, after)| after),
            };
        }
        text + rest
    }

    fn note(&mut self, key: &str, value: &str) {
        match key {
            "golden" => self.goldens.extend(value.split(", ").map(Into::into)),
            "given" => self.given += &format!("{value} "),
            "counted" => self.counted += &format!("{value} "),
            "once" => self.once += &format!("{value} "),
            "derived" => {
                let equations = value.split("; ").map(|it| it.split_once(" = "));
                let equations = equations.map(|it| it.expect("an equation has ' = '"));
                self.derived
                    .extend(equations.map(|(figure, terms)| (figure.into(), terms.into())));
            }
            _ => panic!("comment '{key}:' is none of golden, given, derived, counted, once"),
        }
    }
}

/// Returns the golden files that a text links.
fn linked(text: &str) -> impl Iterator<Item = String> {
    let ends = text.split("tests/golden/").skip(1);
    ends.filter_map(|end| Some(end.split_once(')')?.0.to_owned()))
        .filter(|name| name.ends_with(".txt"))
}

/// Returns the text before, between and after two marks.
fn between<'a>(text: &'a str, open: &str, close: &str) -> Option<(&'a str, &'a str, &'a str)> {
    let (before, rest) = text.split_once(open)?;
    let (inner, after) = rest.split_once(close)?;
    Some((before, inner, after))
}

/// Takes spans of code, targets of links, tags and citations out of a text.
fn prose(text: &str) -> String {
    let mut text = text.to_owned();
    for (open, close, put) in [("`", "`", "a"), ("](", ")", "]"), ("<", ">", "")] {
        let mut left = String::new();
        let mut rest = text.as_str();
        while let Some((before, inner, after)) = between(rest, open, close) {
            left.push_str(before);
            // A lone sign is no mark: "p < 0.0001".
            let is_lone = open == "<" && inner.starts_with(' ');
            let is_mark = !is_lone && !inner.contains("\n\n");
            left.push_str(if is_mark { put } else { open });
            rest = if is_mark {
                after
            } else {
                &rest[before.len() + open.len()..]
            };
        }
        text = left + rest;
    }
    without_citations(&text)
}

/// Takes `[Jorge15, eq. 3]` and the like out: a name, a year, anything.
fn without_citations(text: &str) -> String {
    let mut left = String::new();
    let mut rest = text;
    while let Some((before, inner, after)) = between(rest, "[", "]") {
        let name = inner.trim_start_matches(char::is_alphabetic);
        let is_citation =
            name.len() < inner.len() && name.starts_with(|c: char| c.is_ascii_digit());
        left.push_str(before);
        if !is_citation {
            left.push_str(inner);
        }
        rest = after;
    }
    left + rest
}
