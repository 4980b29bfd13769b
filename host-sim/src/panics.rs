//! Catches panics of a device or a trial in this process, with their place.

use core::cell::{Cell, RefCell};
use core::panic::AssertUnwindSafe;
use std::panic::{self, PanicHookInfo};
use std::sync::Once;

thread_local! {
    static CATCHING: Cell<bool> = const { Cell::new(false) };
    static LAST: RefCell<String> = const { RefCell::new(String::new()) };
}

/// Runs `act`. A panic is returned as place and message, and not printed.
///
/// # Errors
/// The place and the message of the panic.
pub(crate) fn caught<T>(act: impl FnOnce() -> T) -> Result<T, (String, String)> {
    static HOOK: Once = Once::new();
    HOOK.call_once(|| {
        let usual = panic::take_hook();
        panic::set_hook(Box::new(move |info| {
            if CATCHING.get() {
                LAST.set(place(info));
            } else {
                usual(info);
            }
        }));
    });
    let before = CATCHING.replace(true);
    let result = panic::catch_unwind(AssertUnwindSafe(act));
    CATCHING.set(before);
    result.map_err(|payload| {
        let text = payload.downcast_ref::<String>().map(String::as_str);
        let text = text.or_else(|| payload.downcast_ref::<&str>().copied());
        (LAST.take(), text.unwrap_or_default().to_owned())
    })
}

/// File and line, without the folders above the project.
fn place(info: &PanicHookInfo<'_>) -> String {
    info.location().map_or_else(String::new, |at| {
        let file = at.file();
        let from = file.find("firmware/").unwrap_or(0);
        format!("{}:{}", &file[from..], at.line())
    })
}

#[cfg(test)]
mod tests {
    use super::caught;

    #[test]
    fn a_panic_is_returned_with_place_and_message() {
        assert_eq!(caught(|| 7), Ok(7));
        let (place, text) = caught(|| panic!("x {}", 1)).unwrap_err();
        assert!(place.contains("panics.rs:"), "{place}");
        assert_eq!(text, "x 1");
    }
}
