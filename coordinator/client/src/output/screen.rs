//! Screen: a whole terminal that is written again and again, and is as it was afterwards, however that ends.

use super::text::Look;
use console::Term;
use rustix::termios::{
    LocalModes, OptionalActions, SpecialCodeIndex, Termios, tcgetattr, tcsetattr,
};
use std::io::{Read, Write as _};

/// The other page of a terminal, which has no history (xterm, and all that follow it), without a cursor; wider lines
/// are cut.
const OPEN: &str = "\x1b[?1049h\x1b[?25l\x1b[?7l\x1b[2J";
const CLOSE: &str = "\x1b[?7h\x1b[?25h\x1b[?1049l";
const HOME: &str = "\x1b[H";
const REST_OF_LINE: &str = "\x1b[K";
const REST_OF_SCREEN: &str = "\x1b[J";

/// A terminal that is held.
pub struct Screen {
    term: Term,
    /// How its keyboard was before.
    before: Option<Termios>,
}

impl Screen {
    /// Takes the terminal of standard output; `None` where it is none.
    pub fn open() -> Option<Self> {
        let term = Term::stdout();
        if !term.is_term() {
            return None;
        }
        let before = keys_at_once();
        let _ = (&term).write_all(OPEN.as_bytes());
        Some(Self { term, before })
    }

    /// Number of lines, and the look of them.
    pub fn size(&self) -> (usize, Look) {
        let (rows, _) = self.term.size();
        (usize::from(rows), Look::of_standard_output())
    }

    /// Writes a text of less lines than there are.
    pub fn show(&mut self, text: &str) {
        let mut frame = HOME.to_owned();
        for line in text.lines() {
            frame.push_str(line);
            frame.push_str(REST_OF_LINE);
            frame.push_str("\r\n");
        }
        frame.push_str(REST_OF_SCREEN);
        // A terminal that is gone ends the command by its own signal.
        let _ = (&self.term).write_all(frame.as_bytes());
        let _ = self.term.flush();
    }

    /// The key that was typed since the last look, if one was.
    pub fn key(&self) -> Option<u8> {
        self.before.as_ref()?;
        let mut key = [0];
        match std::io::stdin().lock().read(&mut key) {
            Ok(1) => Some(key[0]),
            _ => None,
        }
    }
}

/// Keys come one by one, are not shown, and nobody waits for them; gives how it was before.
fn keys_at_once() -> Option<Termios> {
    let stdin = std::io::stdin();
    let before = tcgetattr(&stdin).ok()?;
    let mut raw_mode = before.clone();
    raw_mode.local_modes -= LocalModes::ICANON | LocalModes::ECHO;
    raw_mode.special_codes[SpecialCodeIndex::VMIN] = 0;
    raw_mode.special_codes[SpecialCodeIndex::VTIME] = 0;
    tcsetattr(&stdin, OptionalActions::Now, &raw_mode).ok()?;
    Some(before)
}

impl Drop for Screen {
    fn drop(&mut self) {
        let _ = (&self.term).write_all(CLOSE.as_bytes());
        if let Some(before) = &self.before {
            let _ = tcsetattr(std::io::stdin(), OptionalActions::Now, before);
        }
    }
}
