//! Data within a page: a text that no parser of HTML can take for anything else.

use std::io::{self, Write as _};

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use flate2::Compression;
use flate2::write::GzEncoder;
use serde::Serialize;

/// A longer text is compressed \[bytes\].
const LONG: usize = 60_000;

/// What stands in a `<script>` that is no program.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub(super) struct Embedded {
    /// `text`: as it is, but for `&` and `<`, which stand as `&amp;` and `&lt;`; `gzip`: compressed, in base 64.
    encoding: &'static str,
    text: String,
}

impl Embedded {
    pub(super) fn new(text: &str) -> io::Result<Self> {
        if text.len() <= LONG {
            let text = text.replace('&', "&amp;").replace('<', "&lt;");
            return Ok(Self { encoding: "text", text });
        }
        // Without a name and a time in its header the same text gives the same bytes.
        let mut encoder = GzEncoder::new(Vec::new(), Compression::best());
        encoder.write_all(text.as_bytes())?;
        Ok(Self { encoding: "gzip", text: STANDARD.encode(encoder.finish()?) })
    }
}

#[cfg(test)]
mod tests {
    use std::io::Read as _;

    use super::*;

    #[test]
    fn nothing_in_a_short_text_ends_the_script() {
        let embedded = Embedded::new("a,b\n</script>,<!-- & &lt;\n").unwrap();
        assert_eq!(embedded.encoding, "text");
        assert_eq!(embedded.text, "a,b\n&lt;/script>,&lt;!-- &amp; &amp;lt;\n");
        assert_eq!(
            embedded.text.replace("&lt;", "<").replace("&amp;", "&"),
            "a,b\n</script>,<!-- & &lt;\n"
        );
    }

    #[test]
    fn a_long_text_comes_back_whole() {
        let text = "1.25,inf,</script>\n".repeat(10_000);
        let embedded = Embedded::new(&text).unwrap();
        assert_eq!(embedded.encoding, "gzip");
        assert!(embedded.text.len() < text.len() / 50);
        let bytes = STANDARD.decode(&embedded.text).unwrap();
        let mut found = String::new();
        flate2::read::GzDecoder::new(&bytes[..]).read_to_string(&mut found).unwrap();
        assert_eq!(found, text);
    }
}
