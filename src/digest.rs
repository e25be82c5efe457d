//! A short name for a long text.

use std::fmt::Write as _;

use sha2::{Digest, Sha256};

/// The first 16 hexadecimal digits of a text's SHA-256.
pub(crate) fn digest(text: &str) -> String {
    hexadecimal(&Sha256::digest(text)[..8])
}

/// The SHA-256 of a file's content, all 64 hexadecimal digits.
#[cfg(feature = "harness")]
pub(crate) fn sha256(bytes: &[u8]) -> String {
    hexadecimal(&Sha256::digest(bytes))
}

fn hexadecimal(bytes: &[u8]) -> String {
    bytes.iter().fold(String::new(), |mut hex, byte| {
        let _ = write!(hex, "{byte:02x}");
        hex
    })
}

#[cfg(test)]
mod tests {
    /// The value for "abc" is the first example of NIST's FIPS 180-4 test vectors.
    #[test]
    fn is_the_beginning_of_sha_256() {
        assert_eq!(super::digest("abc"), "ba7816bf8f01cfea");
    }
}
