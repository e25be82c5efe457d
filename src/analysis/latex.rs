//! Tables for LaTeX.

use std::fmt::Write;

use polars::prelude::*;

use super::format::{cell, cells, shown};

/// Most rows of a table that floats; one of more goes over pages.
const MOST_ROWS: usize = 45;
/// Width of two journal columns, and room between two columns of a table \[pt\].
const PAGE: f64 = 505.0;
const GAP: f64 = 6.0;
/// Width of a letter at `\\footnotesize` \[pt\], a little more than a digit's.
const LETTER: f64 = 4.3;
/// Texts wider than this are broken \[pt\].
const WIDEST: f64 = 150.0;
/// Letters of a heading that stay in one line.
const HEADING: usize = 9;

/// A column as LaTeX has it.
struct Written {
    /// The lines of its heading.
    heading: Vec<String>,
    cells: Vec<String>,
    alignment: char,
    /// Whether its cells are broken into lines.
    is_broken: bool,
    /// \[pt\]
    width: f64,
}

/// A table in LaTeX with its caption and a label, `tab:NAME`, in the rules of the package booktabs, with the cells of
/// [`render`](super::render). It is as wide as two columns of a journal at most: headings are broken, and columns that have
/// no room follow below with the first repeated. A long one is a `longtable`.
pub fn latex(frame: &DataFrame, name: &str, caption: &str) -> PolarsResult<String> {
    let columns = shown(frame);
    let mut rows = Vec::new();
    for i in 0..frame.height() {
        rows.push(cells(&columns, i, cell)?);
    }
    let column = |(k, column): (usize, &&Column)| {
        let cells: Vec<String> = rows.iter().map(|row| row[k].clone()).collect();
        let widest = cells.iter().map(|cell| cell.chars().count()).max().unwrap_or(0);
        let heading = broken(column.name(), widest.max(HEADING));
        let letters = heading.iter().map(|line| line.chars().count()).fold(widest, usize::max);
        let alignment = if column.dtype().is_string() { 'l' } else { 'r' };
        let width = LETTER * letters as f64;
        let is_broken = alignment == 'l' && width > WIDEST;
        let width = GAP + if is_broken { WIDEST } else { width };
        Written { heading, cells, alignment, is_broken, width }
    };
    let written: Vec<Written> = columns.iter().enumerate().map(column).collect();
    let parts = parts(&written);
    let caption = format!("\\caption{{{}}}\\label{{tab:{name}}}", in_latex(caption));
    let is_long = frame.height() * parts.len() > MOST_ROWS;
    Ok(if is_long { long(&parts, &caption) } else { floating(&parts, &caption) })
}

/// A float over both columns.
fn floating(parts: &[Vec<&Written>], caption: &str) -> String {
    let tables: Vec<String> = parts
        .iter()
        .map(|part| {
            format!(
                "\\begin{{tabular}}{{{}}}\n\\toprule\n{}\\midrule\n{}\\bottomrule\n\\end{{tabular}}\n",
                alignments(part),
                header(part),
                body(part)
            )
        })
        .collect();
    format!(
        "% \\usepackage{{booktabs}}\n\\begin{{table*}}\n{caption}\n\\centering\\footnotesize\n\
         \\setlength{{\\tabcolsep}}{{3pt}}\n{}\\end{{table*}}\n",
        tables.join("\n\\medskip\n\n")
    )
}

/// Over as many pages as it takes; the caption stands at the first part.
fn long(parts: &[Vec<&Written>], caption: &str) -> String {
    let mut text = "% \\usepackage{booktabs,longtable}; a longtable stands in one column, behind \\onecolumn.\n\
                    \\begingroup\\footnotesize\n\\setlength{\\tabcolsep}{3pt}\n"
        .to_owned();
    for (i, part) in parts.iter().enumerate() {
        let caption = if i == 0 { format!("{caption}\\\\\n") } else { String::new() };
        let header = header(part);
        let _ = write!(
            text,
            "\\begin{{longtable}}{{{}}}\n{caption}\\toprule\n{header}\\midrule\n\\endfirsthead\n\
             \\toprule\n{header}\\midrule\n\\endhead\n\\bottomrule\n\\endfoot\n{}\\end{{longtable}}\n",
            alignments(part),
            body(part)
        );
        // Every longtable counts as a table, with a caption or without.
        if i > 0 {
            text.push_str("\\addtocounter{table}{-1}\n");
        }
    }
    text + "\\endgroup\n"
}

/// Columns that fit the page beside each other, the first of all in each part.
fn parts(columns: &[Written]) -> Vec<Vec<&Written>> {
    let Some((first, others)) = columns.split_first() else { return Vec::new() };
    let mut parts = vec![vec![first]];
    let mut width = first.width;
    for column in others {
        let is_begun = parts.last().is_some_and(|part| part.len() > 1);
        if width + column.width > PAGE && is_begun {
            parts.push(vec![first]);
            width = first.width;
        }
        parts.last_mut().into_iter().for_each(|part| part.push(column));
        width += column.width;
    }
    parts
}

fn alignments(part: &[&Written]) -> String {
    let of = |column: &&Written| {
        if column.is_broken { format!("p{{{WIDEST}pt}}") } else { column.alignment.to_string() }
    };
    part.iter().map(of).collect()
}

fn header(part: &[&Written]) -> String {
    let cell = |column: &&Written| {
        let lines: Vec<String> = column.heading.iter().map(|line| in_latex(line)).collect();
        match lines.as_slice() {
            [line] => line.clone(),
            lines => format!(
                "\\begin{{tabular}}[b]{{@{{}}{}@{{}}}}{}\\end{{tabular}}",
                column.alignment,
                lines.join("\\\\")
            ),
        }
    };
    row(part.iter().map(cell))
}

fn body(part: &[&Written]) -> String {
    let count = part.first().map_or(0, |column| column.cells.len());
    let cell = |column: &Written, i: usize| {
        let ragged = if column.is_broken { "\\raggedright " } else { "" };
        format!("{ragged}{}", in_latex(&column.cells[i]))
    };
    (0..count).map(|i| row(part.iter().map(|column| cell(column, i)))).collect()
}

fn row(cells: impl Iterator<Item = String>) -> String {
    // Ragged cells have a `\\` of their own.
    format!("{} \\tabularnewline\n", cells.collect::<Vec<_>>().join(" & "))
}

/// A heading in lines of so many letters, longer where a word is.
fn broken(heading: &str, letters: usize) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in heading.split_whitespace() {
        match lines.last_mut() {
            Some(line) if line.chars().count() + 1 + word.chars().count() <= letters => {
                *line += " ";
                *line += word;
            }
            _ => lines.push(word.to_owned()),
        }
    }
    if lines.is_empty() { vec![String::new()] } else { lines }
}

/// A text with what LaTeX reads otherwise.
fn in_latex(text: &str) -> String {
    let mut latex = String::new();
    for character in text.chars() {
        match character {
            '&' | '%' | '#' | '_' | '{' | '}' | '$' => latex.extend(['\\', character]),
            '\\' => latex += "\\textbackslash{}",
            '~' => latex += "\\textasciitilde{}",
            '^' => latex += "\\textasciicircum{}",
            // Behind an end of line it would be a length.
            '[' => latex += "{[}",
            '<' | '>' | '|' => latex.extend(['$', character, '$']),
            '–' => latex += "--",
            '…' => latex += "\\ldots{}",
            '“' => latex += "``",
            '”' => latex += "''",
            '’' => latex.push('\''),
            '\u{a0}' => latex.push('~'),
            other if other.is_control() => latex.push(' '),
            other => match symbol(other) {
                Some(symbol) => latex.extend(["$", symbol, "$"]),
                None => latex.push(other),
            },
        }
    }
    // Exponents of several digits are one.
    latex.replace("}$$^{", "")
}

/// A character of the tables and captions that only LaTeX's mathematics has.
fn symbol(character: char) -> Option<&'static str> {
    Some(match character {
        '≤' => "\\leq",
        '≥' => "\\geq",
        '∞' => "\\infty",
        '°' => "^\\circ",
        '·' => "\\cdot",
        '×' => "\\times",
        '−' => "-",
        '±' => "\\pm",
        '≈' => "\\approx",
        '√' => "\\surd",
        '⁻' => "^{-}",
        '⁰' => "^{0}",
        '¹' => "^{1}",
        '²' => "^{2}",
        '³' => "^{3}",
        '⁴' => "^{4}",
        '⁵' => "^{5}",
        '⁶' => "^{6}",
        '⁷' => "^{7}",
        '⁸' => "^{8}",
        '⁹' => "^{9}",
        'α' => "\\alpha",
        'β' => "\\beta",
        'Δ' => "\\Delta",
        'θ' => "\\theta",
        'ϑ' => "\\vartheta",
        'π' => "\\pi",
        'σ' => "\\sigma",
        'τ' => "\\tau",
        'φ' => "\\varphi",
        'χ' => "\\chi",
        'ψ' => "\\psi",
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_latex_reads_otherwise_is_escaped() {
        assert_eq!(
            in_latex("10⁻⁸ ≤ 5_000 % of a\u{7}<b>"),
            "10$^{-8}$ $\\leq$ 5\\_000 \\% of a $<$b$>$"
        );
        assert_eq!(in_latex("t_f [s]"), "t\\_f {[}s]");
        assert_eq!(in_latex("1.2 °/s² – χ²"), "1.2 $^\\circ$/s$^{2}$ -- $\\chi$$^{2}$");
    }

    fn table(rows: usize, columns: usize) -> String {
        let frame = |k: usize| {
            let name = format!("expected running time {k}");
            Column::new(name.into(), vec![1.234_567; rows])
        };
        let mut columns: Vec<Column> = (0..columns).map(frame).collect();
        columns.insert(0, Column::new("optimiser".into(), vec!["pso/time-free"; rows]));
        latex(&DataFrame::new(rows, columns).unwrap(), "ranks", "Ranks of n ≤ 5 runs.").unwrap()
    }

    #[test]
    fn a_table_floats_over_both_columns_with_its_caption() {
        let text = table(3, 2);
        assert!(text.contains(
            "\\begin{table*}\n\\caption{Ranks of n $\\leq$ 5 runs.}\\label{tab:ranks}\n"
        ));
        assert!(text.contains("\\begin{tabular}{lrr}"), "{text}");
        let heading = "\\begin{tabular}[b]{@{}r@{}}expected\\\\running\\\\time 0\\end{tabular}";
        assert!(text.contains(heading), "{text}");
        assert!(text.trim_end().ends_with("\\end{table*}"));
        assert!(!text.contains("longtable"));
    }

    #[test]
    fn long_texts_are_broken() {
        let labels = ["a label of some length ".repeat(5), "b".to_owned()];
        let frame = df!("first" => &labels, "second" => &labels, "n" => [1.0, 2.0]).unwrap();
        let text = latex(&frame, "pairs", "").unwrap();
        assert!(text.contains("\\begin{tabular}{p{150pt}p{150pt}r}"), "{text}");
        assert!(
            text.contains("\\raggedright b & \\raggedright b & 2.0000 \\tabularnewline"),
            "{text}"
        );
    }

    #[test]
    fn a_long_table_goes_over_pages() {
        let text = table(100, 2);
        for part in ["\\begin{longtable}{lrr}", "\\endfirsthead", "\\endhead", "\\endfoot"] {
            assert_eq!(text.matches(part).count(), 1, "{part}");
        }
        assert!(!text.contains("table*"));
    }

    /// Thirty columns of eight letters at 4.3 pt and a gap are 1200 pt and more.
    #[test]
    fn a_wide_table_goes_on_below() {
        let text = table(3, 30);
        let parts: Vec<&str> = text.matches("\\begin{tabular}{l").collect();
        assert_eq!(parts.len(), 3, "{text}");
        assert_eq!(text.matches("pso/time-free &").count(), 9);
        assert_eq!(text.matches("\\caption").count(), 1);
    }
}
