//! What the machine code of the image does not show, stated: who may be called by address, and how
//! deep a function may call itself.

/// The statements.
#[derive(Clone, Copy, Debug)]
pub struct Rules {
    /// Functions that call by address, each with the functions that it may call.
    pub indirect: &'static [(&'static str, &'static [&'static str])],
    /// Functions of which the image holds the address, and which nobody calls by it.
    pub never_called: &'static [&'static str],
    /// Functions that call themselves, each with the greatest number of its frames.
    pub recursive: &'static [(&'static str, u32)],
    /// Interrupt handlers that are enabled. All have the same priority.
    pub interrupts: &'static [&'static str],
    /// Fault handlers. They run on what a fault leaves of the stack.
    pub faults: &'static [&'static str],
    /// Functions that empty the stack and go on elsewhere.
    pub restarts: &'static [&'static str],
}

/// q at a place, of which a search is told.
const POTENTIAL: &str = "fieldline_planner::planner::steer::\
                         <impl fieldline_planner::planner::step::Step<_,_>>::follow::{{closure}}";

/// The statements for the image. Its sessions set no level of goals (`Config::goal_level`), so the
/// function that would call one calls nobody.
pub const RULES: Rules = Rules {
    indirect: &[
        (
            "fieldline_planner::path::goal_choice::Choice<_,_>::utility_above",
            &[],
        ),
        (
            "fieldline_planner::path::centres::\
             <impl fieldline_planner::path::nearest::Centres<_,_>>::for_each_in_square",
            &["fieldline_planner::strategy::tdbvp::charges::charge_rails::{{closure}}"],
        ),
        (
            "fieldline_planner::drive::search_query::SearchQuery<H>::leads_on",
            &[POTENTIAL],
        ),
        (
            "fieldline_planner::drive::search_query::SearchQuery<H>::leads_on::{{closure}}",
            &[POTENTIAL],
        ),
        (
            "fieldline_planner::drive::roll_out::roll_out",
            &[
                "fieldline_planner::drive::search_query::SearchQuery<H>::leads_on::{{closure}}",
                "fieldline_planner::drive::direct::velocity::{{closure}}::{{closure}}",
            ],
        ),
    ],
    // The compiler writes them for calls of a closure that is given away; the planner only lends.
    // The fault handler compares addresses with those of the other two.
    never_called: &[
        "core::ops::function::FnOnce::call_once{{vtable.shim}}",
        "fieldline_can_read",
        "fieldline_cannot_read",
    ],
    // Sides of 64, 32, 16, 8 and 4 cells.
    recursive: &[("fieldline_planner::field::pyramid::Pyramid::solve", 5)],
    // The last one is the handler of every exception that the image does not expect.
    interrupts: &["USART1", "SysTick", "DefaultHandler"],
    faults: &["HardFault", "BusFault"],
    restarts: &["HardFault", "fieldline_restart"],
};
