//! Bound of the stack that an image takes, from the calls in its machine code.
//!
//! The bound holds for every input, because it counts every path through the program and none of
//! the values. It is the deepest chain of calls from the reset on, the deepest interrupt on top of
//! it, and a fault on top of that. [`RULES`] states what the code cannot show: who is called by
//! address, and how deep a function calls itself. A call that no rule covers is an error, not a
//! guess. Units: bytes.

mod program;
mod rules;
mod thumb;

use std::collections::{BTreeMap, BTreeSet};

pub use program::{Function, Program, read};
pub use rules::{RULES, Rules};

use crate::table::Table;

/// Bytes that the processor stores for an interrupt or a fault: 8 words, 18 of the floating-point
/// unit, and one to align them.
const EXCEPTION_FRAME: u32 = 4 * (8 + 18 + 1);

/// Number of functions in the list of those with the largest frames.
const LARGEST: usize = 20;

/// A chain of calls, the outermost first, and the bytes that all of them take together.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Chain {
    /// Bytes of the whole chain.
    pub bytes: u32,
    /// Addresses of the functions.
    pub functions: Vec<u32>,
}

/// Bounds of an image's stack.
#[derive(Clone, Debug, Default)]
pub struct Bounds {
    /// The deepest chain from the reset on.
    pub program: Chain,
    /// The deepest chain of an interrupt.
    pub interrupt: Chain,
    /// The deepest chain of those that start at the top of an emptied stack, after a crash.
    pub crash: Chain,
    /// What no rule covers: one sentence each.
    pub unknown: Vec<String>,
}

impl Bounds {
    /// Returns the bytes that the stack must have.
    #[must_use]
    pub fn bytes(&self) -> u32 {
        // An interrupt does not interrupt another one: all have the same priority.
        let running = self.program.bytes + EXCEPTION_FRAME + self.interrupt.bytes;
        (running + EXCEPTION_FRAME).max(self.crash.bytes)
    }
}

/// Finds the deepest chains of a program.
struct Search<'a> {
    program: &'a Program,
    rules: &'a Rules,
    /// The deepest chain from each function that was visited.
    deepest: BTreeMap<u32, Chain>,
    /// Functions under way, the outermost first.
    way: Vec<u32>,
    unknown: BTreeSet<String>,
    /// Functions that start on an emptied stack.
    restarted: BTreeSet<u32>,
}

/// Bounds the stack of a program.
#[must_use]
pub fn bounds(program: &Program, rules: &Rules) -> Bounds {
    let mut search = Search {
        program,
        rules,
        deepest: BTreeMap::new(),
        way: Vec::new(),
        unknown: BTreeSet::new(),
        restarted: BTreeSet::new(),
    };
    let main = search.deepest_of(&named(program, "Reset"));
    let interrupts: Vec<u32> = rules
        .interrupts
        .iter()
        .flat_map(|it| named(program, it))
        .collect();
    let interrupt = search.deepest_of(&interrupts);
    let faults: Vec<u32> = rules
        .faults
        .iter()
        .flat_map(|it| named(program, it))
        .collect();
    let _ = search.deepest_of(&faults);
    let restarted: Vec<u32> = search.restarted.iter().copied().collect();
    let crash = search.deepest_of(&restarted);
    if main.bytes == 0 || interrupt.functions.is_empty() || crash.functions.is_empty() {
        search
            .unknown
            .insert("no reset, no interrupt or no crash handler was found".into());
    }
    search.check_rules();
    Bounds {
        program: main,
        interrupt,
        crash,
        unknown: search.unknown.into_iter().collect(),
    }
}

/// Returns the addresses of the functions of that name.
fn named(program: &Program, name: &str) -> Vec<u32> {
    let found = program.iter().filter(|(_, it)| it.name == name);
    found.map(|(address, _)| *address).collect()
}

impl Search<'_> {
    fn deepest_of(&mut self, functions: &[u32]) -> Chain {
        let chains = functions.iter().map(|it| self.visit(*it));
        chains.fold(Chain::default(), deeper)
    }

    fn name(&self, address: u32) -> &str {
        self.program.get(&address).map_or("?", |it| &it.name)
    }

    /// Returns the deepest chain that begins with the function at `address`.
    fn visit(&mut self, address: u32) -> Chain {
        if let Some(chain) = self.deepest.get(&address) {
            return chain.clone();
        }
        let Some(function) = self.program.get(&address) else {
            self.unknown
                .insert(format!("a call of {address:#x}, where no function begins"));
            return Chain::default();
        };
        if let Some(k) = self.way.iter().position(|it| *it == address) {
            let circle: Vec<&str> = self.way[k..].iter().map(|it| self.name(*it)).collect();
            self.unknown
                .insert(format!("recursion of {}", circle.join(" by ")));
            return Chain::default();
        }
        self.way.push(address);
        let mut calls = function.calls.clone();
        // A function of which the rule bounds the depth is all its own calls together.
        let own = calls.remove(&address);
        calls.extend(self.called_by_address(function));
        let times = self.depth(function, own);
        let calls: Vec<u32> = calls.into_iter().collect();
        let mut chain = self.deepest_of(&calls);
        chain.bytes += function.frame * times;
        chain.functions.insert(0, address);
        let jumps: Vec<u32> = function.jumps.iter().copied().collect();
        if function.sets_stack {
            self.restarted.extend(jumps);
        } else {
            let mut instead = self.deepest_of(&jumps);
            instead.functions.insert(0, address);
            chain = deeper(chain, instead);
        }
        self.way.pop();
        self.deepest.insert(address, chain.clone());
        chain
    }

    /// Returns how many frames of a function lie on the stack at most.
    fn depth(&mut self, function: &Function, calls_itself: bool) -> u32 {
        let rule = self
            .rules
            .recursive
            .iter()
            .find(|(name, _)| *name == function.name);
        match rule {
            Some((_, depth)) if calls_itself => *depth,
            _ if calls_itself => {
                self.unknown
                    .insert(format!("recursion of {}", function.name));
                1
            }
            _ => 1,
        }
    }

    /// Returns the functions that a function may call by address.
    fn called_by_address(&mut self, function: &Function) -> Vec<u32> {
        if function.indirect == 0 {
            return Vec::new();
        }
        let rule = self
            .rules
            .indirect
            .iter()
            .find(|(caller, _)| *caller == function.name);
        let Some((_, callees)) = rule else {
            self.unknown
                .insert(format!("calls by address in {}", function.name));
            return Vec::new();
        };
        callees
            .iter()
            .flat_map(|name| named(self.program, name))
            .collect()
    }

    /// Notes the rules that name functions which are not there, functions that may be called by
    /// address and that no rule names, and frames that two sources give differently.
    fn check_rules(&mut self) {
        let rules = self.rules;
        let callees: Vec<&str> = rules.indirect.iter().flat_map(|it| it.1).copied().collect();
        let callers = rules.indirect.iter().map(|it| it.0);
        let names = callers
            .chain(rules.recursive.iter().map(|it| it.0))
            .chain(callees.clone());
        for name in names.chain([rules.interrupts, rules.faults].concat()) {
            if named(self.program, name).is_empty() {
                self.unknown
                    .insert(format!("a rule names {name}, which is not in the image"));
            }
        }
        for function in self.program.values() {
            let name = &*function.name;
            let is_named = callees.contains(&name) || rules.never_called.contains(&name);
            if function.address_is_stored && !is_named {
                self.unknown
                    .insert(format!("no rule says who calls {name} by address"));
            }
            if function.sets_stack && !rules.restarts.contains(&name) {
                self.unknown
                    .insert(format!("{name} moves the stack pointer"));
            }
            if let Some(reserved) = function.reserved.filter(|it| *it != function.frame) {
                self.unknown.insert(format!(
                    "{} takes {} bytes by its instructions and {reserved} by the compiler",
                    function.name, function.frame
                ));
            }
        }
    }
}

/// Returns the deeper of two chains; the first if they are equal.
fn deeper(one: Chain, other: Chain) -> Chain {
    if other.bytes > one.bytes || one.functions.is_empty() {
        other
    } else {
        one
    }
}

/// Makes the text that is committed: the bounds, the deepest chain, and the largest frames.
#[must_use]
pub fn report(program: &Program, bounds: &Bounds) -> String {
    let mut parts = Table::new(1, &["bound", "bytes"]);
    for (what, bytes) in [
        ("program", bounds.program.bytes),
        ("interrupt", EXCEPTION_FRAME + bounds.interrupt.bytes),
        ("fault", EXCEPTION_FRAME),
        ("together", bounds.bytes()),
        ("after a crash", bounds.crash.bytes),
    ] {
        parts.row(vec![what.into(), bytes.to_string()]);
    }
    let mut chain = Table::new(1, &["deepest chain", "frame", "sum"]);
    let mut sum = 0;
    for function in bounds
        .program
        .functions
        .iter()
        .filter_map(|it| program.get(it))
    {
        sum += function.frame;
        chain.row(vec![
            function.name.clone(),
            function.frame.to_string(),
            sum.to_string(),
        ]);
    }
    let mut frames: Vec<&Function> = program.values().collect();
    frames.sort_by(|a, b| b.frame.cmp(&a.frame).then_with(|| a.name.cmp(&b.name)));
    let mut largest = Table::new(1, &["largest frames", "frame"]);
    for function in frames.into_iter().take(LARGEST) {
        largest.row(vec![function.name.clone(), function.frame.to_string()]);
    }
    format!("{parts}\n{chain}\n{largest}")
}

#[cfg(test)]
mod tests {
    use super::{Bounds, Function, Program, Rules, bounds};

    const RULES: Rules = Rules {
        indirect: &[("caller", &["callee"])],
        never_called: &["spare"],
        recursive: &[("deep", 3)],
        interrupts: &["interrupt"],
        faults: &["fault"],
        restarts: &["fault"],
    };

    fn function(name: &str, frame: u32, calls: &[u32], jumps: &[u32]) -> Function {
        Function {
            name: name.into(),
            frame,
            calls: calls.iter().copied().collect(),
            jumps: jumps.iter().copied().collect(),
            ..Function::default()
        }
    }

    /// A program of which every statement of the rules is true.
    fn program() -> Program {
        let mut program: Program = [
            (0, function("Reset", 8, &[2, 4], &[])),
            (2, function("caller", 100, &[], &[6])),
            (4, function("deep", 50, &[4, 8], &[])),
            (6, function("instead", 90, &[8], &[])),
            (8, function("leaf", 20, &[], &[])),
            (10, function("callee", 30, &[], &[])),
            (12, function("interrupt", 16, &[], &[])),
            (14, function("fault", 0, &[], &[16])),
            (16, function("report", 400, &[], &[])),
        ]
        .into();
        program.entry(2).and_modify(|caller| caller.indirect = 1);
        program
            .entry(10)
            .and_modify(|callee| callee.address_is_stored = true);
        program
            .entry(14)
            .and_modify(|fault| fault.sets_stack = true);
        program
    }

    fn changed(change: impl FnOnce(&mut Program)) -> Bounds {
        let mut program = program();
        change(&mut program);
        bounds(&program, &RULES)
    }

    #[test]
    fn the_deepest_chain_counts_repeated_frames_and_leaves_out_those_that_are_gone() {
        let found = changed(|_| ());
        assert_eq!(found.unknown, Vec::<String>::new());
        // Through `deep`; `caller` and `callee` take 130, and `instead` and `leaf` 110.
        assert_eq!(
            (found.program.bytes, &*found.program.functions),
            (178, &[0, 4, 8][..])
        );
        assert_eq!((found.interrupt.bytes, found.crash.bytes), (16, 400));
        assert_eq!(found.bytes(), 178 + 108 + 16 + 108);
        let called = changed(|program| {
            program.entry(10).and_modify(|callee| callee.frame = 80);
        });
        assert_eq!(
            (called.program.bytes, &*called.program.functions),
            (188, &[0, 2, 10][..])
        );
    }

    #[test]
    fn what_no_rule_covers_is_named() {
        let recursion = changed(|program| {
            program.entry(8).and_modify(|leaf| {
                leaf.calls.insert(6);
            });
        });
        assert_eq!(recursion.unknown, ["recursion of instead by leaf"]);
        let indirect = changed(|program| {
            program.entry(8).and_modify(|leaf| leaf.indirect = 1);
        });
        assert_eq!(indirect.unknown, ["calls by address in leaf"]);
        let stored = changed(|program| {
            program
                .entry(8)
                .and_modify(|leaf| leaf.address_is_stored = true);
        });
        assert_eq!(stored.unknown, ["no rule says who calls leaf by address"]);
        let moved = changed(|program| {
            program.entry(8).and_modify(|leaf| leaf.sets_stack = true);
        });
        assert_eq!(moved.unknown, ["leaf moves the stack pointer"]);
        let gone = changed(|program| {
            program.remove(&10);
        });
        assert_eq!(
            gone.unknown,
            ["a rule names callee, which is not in the image"]
        );
        let differs = changed(|program| {
            program.entry(8).and_modify(|leaf| leaf.reserved = Some(24));
        });
        let sentence = "leaf takes 20 bytes by its instructions and 24 by the compiler";
        assert_eq!(differs.unknown, [sentence]);
    }
}
