//! MATLAB's binary files of level 5, which `load` reads without a toolbox (MathWorks, *MAT-File Format*, chapter 1): a header of
//! 128 bytes, then one element per variable, nothing compressed, little-endian.

use super::ExportError;
use super::record::{BASE, Quantity, Record};

/// Types of data.
const INT8: u32 = 1;
const UINT16: u32 = 4;
const INT32: u32 = 5;
const UINT32: u32 = 6;
const DOUBLE: u32 = 9;
const MATRIX: u32 = 14;

/// Classes of arrays.
const CELL: u32 = 1;
const CHAR: u32 = 4;
const REAL: u32 = 6;

/// Columns of [`BASE`] that are one matrix.
const BASE_MATRICES: [(&str, usize, usize); 4] = [
    ("base_quaternion", 0, 4),
    ("base_zyx", 4, 7),
    ("base_position", 7, 10),
    ("base_rate", 10, BASE.len()),
];

/// A motion as variables of their own: a row for each time, a column for each joint.
pub(super) fn motion(record: &Record<'_>) -> Result<Vec<u8>, ExportError> {
    let (times, joints) = (record.time.len(), &record.joints);
    let mut file = header();
    let mut add = |variable: Vec<u8>| {
        // Of an element longer than that readers see a negative length.
        if variable.len() > i32::MAX as usize {
            let reason = "a variable would take more than 2 GiB".to_owned();
            return Err(ExportError::Format { format: "MAT-file", reason });
        }
        file.extend(variable);
        Ok(())
    };
    let texts = |name, texts: &mut dyn Iterator<Item = &str>| {
        let cells: Vec<Vec<u8>> = texts.map(|text| char_array("", text)).collect();
        array(name, CELL, [1, cells.len()], cells.concat())
    };
    add(char_array("robot", record.robot.name()))?;
    add(texts("joint_names", &mut joints.iter().map(|joint| &*joint.motion.name)))?;
    add(texts("joint_units", &mut joints.iter().map(|joint| joint.motion.kind.si_unit())))?;
    let torque_unit = |kind| Quantity::Torque.unit(kind);
    add(texts("torque_units", &mut joints.iter().map(|joint| torque_unit(joint.motion.kind))))?;
    add(matrix("time", [times, 1], record.time.iter().copied()))?;
    for quantity in Quantity::ALL {
        let columns =
            joints.iter().flat_map(|joint| (0..times).map(move |time| joint.at(quantity, time)));
        add(matrix(quantity.name(), [times, joints.len()], columns))?;
    }
    for (name, from, to) in BASE_MATRICES {
        let columns = (from..to).flat_map(|k| record.base.iter().map(move |base| base[k]));
        add(matrix(name, [times, to - from], columns))?;
    }
    Ok(file)
}

/// A text, room for what is not used here, version 1, and the mark by which readers tell the order of bytes.
fn header() -> Vec<u8> {
    let text = "MATLAB 5.0 MAT-file, created by driftless";
    let mut header = format!("{text:<116}").into_bytes();
    header.extend([0; 8]);
    header.extend(0x0100_u16.to_le_bytes());
    header.extend(b"IM");
    header
}

/// A real matrix from its columns.
fn matrix(name: &str, size: [usize; 2], columns: impl Iterator<Item = f64>) -> Vec<u8> {
    array(
        name,
        REAL,
        size,
        element(DOUBLE, &columns.flat_map(f64::to_le_bytes).collect::<Vec<u8>>()),
    )
}

/// A text.
fn char_array(name: &str, text: &str) -> Vec<u8> {
    let units: Vec<u16> = text.encode_utf16().collect();
    let bytes: Vec<u8> = units.iter().flat_map(|unit| unit.to_le_bytes()).collect();
    array(name, CHAR, [1, units.len()], element(UINT16, &bytes))
}

/// An array: its class, size, name and content.
fn array(name: &str, class: u32, size: [usize; 2], content: Vec<u8>) -> Vec<u8> {
    let flags: Vec<u8> = [class, 0].into_iter().flat_map(u32::to_le_bytes).collect();
    let size: Vec<u8> = size.into_iter().flat_map(|n| (n as i32).to_le_bytes()).collect();
    let parts =
        [element(UINT32, &flags), element(INT32, &size), element(INT8, name.as_bytes()), content];
    element(MATRIX, &parts.concat())
}

/// Type, length and bytes, filled up to a multiple of eight.
fn element(kind: u32, bytes: &[u8]) -> Vec<u8> {
    let mut element = Vec::with_capacity(bytes.len() + 16);
    element.extend(kind.to_le_bytes());
    element.extend((bytes.len() as u32).to_le_bytes());
    element.extend(bytes);
    element.resize(element.len().next_multiple_of(8), 0);
    element
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Tags and sizes from the format's description.
    #[test]
    fn variables_are_elements_of_level_5() {
        let found = matrix("ab", [2, 1], [1.0, -2.0].into_iter());
        let expected: Vec<u8> = [
            &[14, 0, 0, 0, 72, 0, 0, 0][..],
            &[6, 0, 0, 0, 8, 0, 0, 0, 6, 0, 0, 0, 0, 0, 0, 0],
            &[5, 0, 0, 0, 8, 0, 0, 0, 2, 0, 0, 0, 1, 0, 0, 0],
            &[1, 0, 0, 0, 2, 0, 0, 0, b'a', b'b', 0, 0, 0, 0, 0, 0],
            &[9, 0, 0, 0, 16, 0, 0, 0],
            &[0, 0, 0, 0, 0, 0, 0xf0, 0x3f, 0, 0, 0, 0, 0, 0, 0, 0xc0],
        ]
        .concat();
        assert_eq!(found, expected);
        let text = char_array("", "é");
        assert_eq!(
            text[40..],
            [1, 0, 0, 0, 0, 0, 0, 0, 4, 0, 0, 0, 2, 0, 0, 0, 0xe9, 0, 0, 0, 0, 0, 0, 0]
        );
    }

    #[test]
    fn the_header_is_told_by_its_mark() {
        let header = header();
        assert_eq!(header.len(), 128);
        assert!(header.starts_with(b"MATLAB 5.0 MAT-file"));
        assert_eq!(header[124..], [0, 1, b'I', b'M']);
    }
}
