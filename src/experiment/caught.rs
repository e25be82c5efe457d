//! Panics caught without their noise: what would have gone to standard error goes into a text.

use std::any::Any;
use std::cell::{Cell, RefCell};
use std::panic::{AssertUnwindSafe, PanicHookInfo, catch_unwind, set_hook, take_hook};
use std::sync::Once;

thread_local! {
    /// Whether this thread is within [`caught`].
    static CATCHING: Cell<bool> = const { Cell::new(false) };
    /// Where its last panic there began.
    static PLACE: RefCell<Option<String>> = const { RefCell::new(None) };
}

/// Does the work. A panic within it, which must be on the same thread, becomes a text: what it said
/// and where.
pub(crate) fn caught<T>(work: impl FnOnce() -> T) -> Result<T, String> {
    install_hook();
    CATCHING.set(true);
    let outcome = catch_unwind(AssertUnwindSafe(work));
    CATCHING.set(false);
    outcome.map_err(|payload| {
        let said = text(&*payload);
        PLACE.take().map_or_else(|| said.to_owned(), |place| format!("{said} ({place})"))
    })
}

/// From now on the program's own hook hears only of panics that nobody catches here.
fn install_hook() {
    static INSTALLED: Once = Once::new();
    INSTALLED.call_once(|| {
        let own = take_hook();
        set_hook(Box::new(move |panic: &PanicHookInfo<'_>| {
            if CATCHING.get() {
                PLACE.set(panic.location().map(ToString::to_string));
            } else {
                own(panic);
            }
        }));
    });
}

fn text(payload: &(dyn Any + Send)) -> &str {
    let owned = payload.downcast_ref::<String>().map(String::as_str);
    owned.or_else(|| payload.downcast_ref::<&str>().copied()).unwrap_or("no message")
}
