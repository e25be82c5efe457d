//! The checksum of a stored file, within the file.
//!
//! A Parquet file is read from its end: the footer there says where everything else is. What stands between the last
//! column and the footer is nobody's, so any reader takes the file, and file and checksum are written, renamed and copied
//! as one.

use sha2::{Digest, Sha256};

/// What stands before and behind the checksum; no text, so no column has it.
const MARK: [u8; 16] = *b"\x89driftless seal\n";

/// Bytes of a checksum.
const CHECKSUM: usize = 32;

/// What ends a Parquet file, behind the length of the footer.
const MAGIC: &[u8] = b"PAR1";

/// Puts the SHA-256 of all bytes of a Parquet file, between two marks, before its footer.
pub(super) fn sealed(mut bytes: Vec<u8>) -> Vec<u8> {
    if let Some(footer) = footer(&bytes) {
        let checksum = Sha256::digest(&bytes);
        bytes.splice(footer..footer, [&MARK[..], &checksum, &MARK].concat());
    }
    bytes
}

/// What the checksum says of a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Seal {
    /// The bytes are those that were written.
    Whole,
    /// They are not.
    Broken,
    /// There is none: the file is from before there were checksums, or somebody else's.
    None,
}

/// Compares the bytes of a file with its checksum.
pub(super) fn seal_of(bytes: &[u8]) -> Seal {
    if !bytes.windows(MARK.len()).rev().any(|window| window == MARK) {
        return Seal::None;
    }
    let parts = || {
        let (before, footer) = bytes.split_at_checked(footer(bytes)?)?;
        let seal = before.len().checked_sub(2 * MARK.len() + CHECKSUM)?;
        let (columns, seal) = before.split_at_checked(seal)?;
        let checksum = seal.strip_prefix(&MARK)?.strip_suffix(&MARK)?;
        Some((columns, checksum, footer))
    };
    let is_whole = parts().is_some_and(|(columns, checksum, footer)| {
        *checksum == *Sha256::new().chain_update(columns).chain_update(footer).finalize()
    });
    if is_whole { Seal::Whole } else { Seal::Broken }
}

/// Where the footer begins: before the last eight bytes, which are its length and the magic number.
fn footer(bytes: &[u8]) -> Option<usize> {
    let (before, length) = bytes.strip_suffix(MAGIC)?.split_last_chunk()?;
    before.len().checked_sub(u32::from_le_bytes(*length) as usize)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A file of four bytes of columns and a footer of three, as the format's description has it.
    const PLAIN: &[u8] = b"PAR1colsfoo\x03\x00\x00\x00PAR1";

    #[test]
    fn the_checksum_stands_before_the_footer() {
        let sealed = sealed(PLAIN.to_vec());
        assert_eq!(sealed.len(), PLAIN.len() + 64);
        assert_eq!(&sealed[..8], &PLAIN[..8]);
        assert_eq!(&sealed[72..], &PLAIN[8..]);
        // `printf 'PAR1colsfoo\003\000\000\000PAR1' | sha256sum`
        let half = |at: usize| u128::from_be_bytes(sealed[at..at + 16].try_into().unwrap());
        let checksum = format!("{:032x}{:032x}", half(24), half(40));
        assert_eq!(checksum, "d83f33becb157e25899380b5cf6fc4cdcc5466f17c68ce720f96f79b3aa5732e");
    }

    #[test]
    fn every_bit_is_covered() {
        let whole = sealed(PLAIN.to_vec());
        assert_eq!(seal_of(&whole), Seal::Whole);
        for bit in 0..8 * whole.len() {
            let mut bytes = whole.clone();
            bytes[bit / 8] ^= 1 << (bit % 8);
            assert_eq!(seal_of(&bytes), Seal::Broken, "bit {bit}");
        }
        // Cut off anywhere behind the first mark, it is damaged; before that it is for Parquet to say.
        for length in 24..whole.len() {
            assert_eq!(seal_of(&whole[..length]), Seal::Broken, "{length} bytes");
        }
    }

    #[test]
    fn files_without_a_checksum_are_taken_as_they_are() {
        assert_eq!(seal_of(PLAIN), Seal::None);
        assert_eq!(sealed(b"no table".to_vec()), b"no table");
    }
}
