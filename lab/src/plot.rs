//! Plots as SVG, with a paper of their own so that they can be read on any background, and dark where the reader's page is.

use std::fmt::Write;

/// Lines over evenly spaced places.
pub struct Panel {
    pub title: String,
    /// Names of the places.
    pub places: Vec<String>,
    /// Values at each place; one line of each series, and none where it is empty.
    pub lines: Vec<Vec<f64>>,
}

/// A row of a grid or a group of bars.
pub struct Row {
    pub name: String,
    pub values: Vec<Option<f64>>,
}

const STYLE: &str = "<style>\
    .paper{fill:#ffffff}text{fill:#24292f;font:12px sans-serif}.small{font-size:10px}.rule{stroke:#d0d7de}\
    .aim{stroke:#cf222e;stroke-dasharray:4 3}\
    .s0{--c:#8c959f}.s1{--c:#2f81f7}.s2{--c:#2da44e}.s3{--c:#e07b00}.s4{--c:#a371f7}\
    .line{fill:none;stroke:var(--c);stroke-width:2}.dot{fill:var(--c)}\
    @media (prefers-color-scheme:dark){.paper{fill:#0d1117}text{fill:#e6edf3}.rule{stroke:#3d444d}.aim{stroke:#ff7b72}}\
    </style>";

/// Panels in rows of `columns`, all from 0 to `most`, under one legend.
pub fn panels(title: &str, series: &[&str], panels: &[Panel], columns: usize, most: f64) -> String {
    const SIZE: (f64, f64) = (210.0, 150.0);
    const INNER: (f64, f64) = (160.0, 95.0);
    let rows = panels.len().div_ceil(columns.max(1));
    let (width, height) = (20.0 + SIZE.0 * columns as f64, 60.0 + SIZE.1 * rows as f64);
    let mut svg = Svg::new(width, height, title);
    svg.legend(series, 10.0, 42.0);
    for (number, panel) in panels.iter().enumerate() {
        let left = 45.0 + SIZE.0 * (number % columns) as f64;
        let top = 80.0 + SIZE.1 * (number / columns) as f64;
        let x =
            |place: usize| left + INNER.0 * (place as f64 + 0.5) / panel.places.len().max(1) as f64;
        let y = |value: f64| top + INNER.1 * (1.0 - (value / most).clamp(0.0, 1.0));
        svg.text(left, top - 7.0, "start", "", &panel.title);
        for part in [0.0, 0.5, 1.0] {
            svg.rule(left, left + INNER.0, y(part * most), "rule");
            svg.text(
                left - 5.0,
                y(part * most) + 4.0,
                "end",
                "small",
                &number_of(part * most),
            );
        }
        for (place, name) in panel.places.iter().enumerate() {
            svg.text(x(place), top + INNER.1 + 14.0, "middle", "small", name);
        }
        for (series, values) in panel.lines.iter().enumerate() {
            // Lines that lie on each other are drawn beside each other.
            let shift = 1.5 * (series as f64 - panel.lines.len() as f64 / 2.0);
            let points: Vec<(f64, f64)> = values
                .iter()
                .enumerate()
                .map(|(place, &value)| (x(place) + 2.0 * shift, y(value) + shift))
                .collect();
            svg.line(series, &points);
        }
    }
    svg.end()
}

/// Groups of bars from 0 to `most`, with dashed lines at values that matter.
pub fn bars(title: &str, series: &[&str], groups: &[Row], most: f64, aims: &[f64]) -> String {
    const INNER: f64 = 200.0;
    const BAR: f64 = 14.0;
    const GAP: f64 = 40.0;
    let group = BAR * series.len() as f64 + GAP;
    let (width, height) = (70.0 + group * groups.len() as f64, INNER + 120.0);
    let mut svg = Svg::new(width.max(420.0), height, title);
    svg.legend(series, 10.0, 42.0);
    let top = 65.0;
    let y = |value: f64| top + INNER * (1.0 - (value / most).clamp(0.0, 1.0));
    let right = 45.0 + group * groups.len() as f64;
    for part in [0.0, 0.25, 0.5, 0.75, 1.0] {
        svg.rule(45.0, right, y(part * most), "rule");
        svg.text(
            40.0,
            y(part * most) + 4.0,
            "end",
            "small",
            &number_of(part * most),
        );
    }
    for (number, row) in groups.iter().enumerate() {
        let left = 45.0 + group * number as f64 + GAP / 2.0;
        for (series, value) in row.values.iter().enumerate() {
            let Some(value) = value else { continue };
            let x = left + BAR * series as f64;
            svg.bar(series, x, y(*value), BAR - 2.0, top + INNER - y(*value));
            // What the scale does not show is said.
            if *value > most {
                svg.text(
                    x + BAR / 2.0,
                    y(most) - 3.0,
                    "middle",
                    "small",
                    &format!("{value:.0}"),
                );
            }
        }
        let middle = left + (group - GAP) / 2.0;
        let mut line = top + INNER + 14.0;
        for word in row.name.split(", ") {
            svg.text(middle, line, "middle", "small", word);
            line += 13.0;
        }
    }
    for &aim in aims {
        svg.rule(45.0, right, y(aim), "aim");
    }
    svg.end()
}

/// Shares from 0 to 1, each in percent on a ground as dark as it is large.
pub fn grid(title: &str, columns: &[&str], rows: &[Row]) -> String {
    const CELL: (f64, f64) = (74.0, 22.0);
    const LEFT: f64 = 165.0;
    const TOP: f64 = 75.0;
    let (width, height) = (
        LEFT + CELL.0 * columns.len() as f64 + 10.0,
        TOP + CELL.1 * rows.len() as f64 + 10.0,
    );
    let mut svg = Svg::new(width, height, title);
    for (column, name) in columns.iter().enumerate() {
        let middle = LEFT + CELL.0 * (column as f64 + 0.5);
        for (line, word) in name.split(", ").enumerate() {
            svg.text(
                middle,
                TOP - 22.0 + 13.0 * line as f64,
                "middle",
                "small",
                word,
            );
        }
    }
    for (number, row) in rows.iter().enumerate() {
        let top = TOP + CELL.1 * number as f64;
        svg.text(LEFT - 8.0, top + 15.0, "end", "", &row.name);
        for (column, value) in row.values.iter().enumerate() {
            let Some(value) = value else { continue };
            let left = LEFT + CELL.0 * column as f64;
            svg.cell(left, top, (CELL.0 - 2.0, CELL.1 - 2.0), *value);
            let percent = format!("{:.0} %", 100.0 * value);
            svg.text(left + CELL.0 / 2.0, top + 14.0, "middle", "small", &percent);
        }
    }
    svg.end()
}

/// An axis: its name, its ends, and the places that are marked.
pub struct Axis<'a> {
    pub name: &'a str,
    pub ends: (f64, f64),
    pub marks: Vec<(f64, String)>,
}

/// Lines through points, one of each series, cut off at the axes' ends; the first series is dashed, as what the others are held against.
pub fn curves(
    title: &str,
    [x, y]: [&Axis; 2],
    series: &[&str],
    lines: &[Vec<(f64, f64)>],
) -> String {
    const INNER: (f64, f64) = (520.0, 240.0);
    const LEFT: f64 = 60.0;
    const TOP: f64 = 62.0;
    let along = |axis: &Axis, value: f64| {
        ((value - axis.ends.0) / (axis.ends.1 - axis.ends.0)).clamp(0.0, 1.0)
    };
    let place = |(a, b): (f64, f64)| {
        (
            LEFT + INNER.0 * along(x, a),
            TOP + INNER.1 * (1.0 - along(y, b)),
        )
    };
    let mut svg = Svg::new(LEFT + INNER.0 + 30.0, TOP + INNER.1 + 50.0, title);
    svg.legend(series, 10.0, 42.0);
    for (value, name) in &y.marks {
        let (left, height) = place((x.ends.0, *value));
        svg.rule(left, left + INNER.0, height, "rule");
        svg.text(left - 6.0, height + 4.0, "end", "small", name);
    }
    for (value, name) in &x.marks {
        let (left, height) = place((*value, y.ends.0));
        svg.text(left, height + 15.0, "middle", "small", name);
    }
    let middle = LEFT + INNER.0 / 2.0;
    svg.text(
        middle,
        TOP + INNER.1 + 36.0,
        "middle",
        "",
        &format!("{} against {}", y.name, x.name),
    );
    for (number, line) in lines.iter().enumerate() {
        let points: Vec<(f64, f64)> = line.iter().map(|&point| place(point)).collect();
        svg.curve(number, &points);
    }
    svg.end()
}

/// A number without needless zeros.
fn number_of(value: f64) -> String {
    let text = format!("{value:.2}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

struct Svg(String);

impl Svg {
    fn new(width: f64, height: f64, title: &str) -> Svg {
        let mut svg = Svg(format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width:.0} {height:.0}\" width=\"{width:.0}\" \
             height=\"{height:.0}\" role=\"img\">\n<title>{}</title>\n{STYLE}\n\
             <rect class=\"paper\" width=\"100%\" height=\"100%\" rx=\"6\"/>\n",
            escaped(title)
        ));
        svg.text(10.0, 20.0, "start", "", title);
        svg
    }

    fn text(&mut self, x: f64, y: f64, anchor: &str, class: &str, text: &str) {
        let class = if class.is_empty() {
            String::new()
        } else {
            format!(" class=\"{class}\"")
        };
        let text = escaped(text);
        let _ = writeln!(
            self.0,
            "<text x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"{anchor}\"{class}>{text}</text>"
        );
    }

    fn rule(&mut self, left: f64, right: f64, y: f64, class: &str) {
        let _ = writeln!(
            self.0,
            "<line class=\"{class}\" x1=\"{left:.1}\" x2=\"{right:.1}\" y1=\"{y:.1}\" y2=\"{y:.1}\"/>"
        );
    }

    fn line(&mut self, series: usize, points: &[(f64, f64)]) {
        if points.is_empty() {
            return;
        }
        let list: Vec<String> = points
            .iter()
            .map(|(x, y)| format!("{x:.1},{y:.1}"))
            .collect();
        let _ = writeln!(
            self.0,
            "<g class=\"s{series}\"><polyline class=\"line\" points=\"{}\"/>",
            list.join(" ")
        );
        for (x, y) in points {
            let _ = writeln!(
                self.0,
                "<circle class=\"dot\" cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"3\"/>"
            );
        }
        self.0.push_str("</g>\n");
    }

    fn curve(&mut self, series: usize, points: &[(f64, f64)]) {
        let list: Vec<String> = points
            .iter()
            .map(|(x, y)| format!("{x:.1},{y:.1}"))
            .collect();
        let dashed = if series == 0 {
            " stroke-dasharray=\"5 4\""
        } else {
            ""
        };
        let _ = writeln!(
            self.0,
            "<g class=\"s{series}\"><polyline class=\"line\"{dashed} points=\"{}\"/></g>",
            list.join(" ")
        );
    }

    fn bar(&mut self, series: usize, x: f64, y: f64, width: f64, height: f64) {
        let _ = writeln!(
            self.0,
            "<g class=\"s{series}\"><rect class=\"dot\" x=\"{x:.1}\" y=\"{y:.1}\" width=\"{width:.1}\" height=\"{height:.1}\"/></g>"
        );
    }

    fn cell(&mut self, x: f64, y: f64, (width, height): (f64, f64), share: f64) {
        let opacity = 0.08 + 0.62 * share.clamp(0.0, 1.0);
        let _ = writeln!(
            self.0,
            "<g class=\"s1\"><rect class=\"dot\" x=\"{x:.1}\" y=\"{y:.1}\" width=\"{width:.1}\" height=\"{height:.1}\" \
             fill-opacity=\"{opacity:.2}\"/></g>"
        );
    }

    fn legend(&mut self, series: &[&str], left: f64, y: f64) {
        let mut x = left;
        for (number, name) in series.iter().enumerate() {
            self.bar(number, x, y - 9.0, 10.0, 10.0);
            self.text(x + 15.0, y, "start", "", name);
            x += 35.0 + 6.5 * name.chars().count() as f64;
        }
    }

    fn end(mut self) -> String {
        self.0.push_str("</svg>\n");
        self.0
    }
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
}

#[cfg(test)]
#[allow(clippy::unwrap_used)] // a test that unwraps nothing fails, as it should
mod tests {
    use super::*;

    /// Every element that is opened is closed, and no coordinate is anything but a number.
    fn check(svg: &str) {
        let mut open = Vec::new();
        for tag in svg
            .split('<')
            .skip(1)
            .map(|part| &part[..part.find('>').unwrap()])
        {
            let name = tag
                .trim_start_matches('/')
                .split([' ', '/'])
                .next()
                .unwrap();
            if tag.starts_with('/') {
                assert_eq!(open.pop(), Some(name), "{svg}");
            } else if !tag.ends_with('/') {
                open.push(name);
            }
        }
        assert!(open.is_empty(), "{open:?}");
        assert!(!svg.contains("NaN") && !svg.contains("inf"), "{svg}");
    }

    #[test]
    fn panels_draw_each_line_at_its_values() {
        let panel = Panel {
            title: "a < b & c".to_owned(),
            places: vec!["0".to_owned(), "1".to_owned()],
            lines: vec![vec![0.0, 0.5], Vec::new(), vec![0.25, 0.25]],
        };
        let svg = panels("title", &["x", "y", "z"], &[panel], 1, 0.5);
        check(&svg);
        assert!(svg.contains("a &lt; b &amp; c"));
        assert_eq!(
            svg.matches("<polyline").count(),
            2,
            "a line without values is none"
        );
        // Between them half the height of the panel.
        let heights: Vec<f64> = svg
            .split("cy=\"")
            .skip(1)
            .map(|part| part.split('"').next().unwrap().parse().unwrap())
            .collect();
        assert!((heights[0] - heights[1] - 95.0).abs() < 0.11, "{heights:?}");
        assert!((heights[2] - heights[3]).abs() < 1e-9);
    }

    #[test]
    fn curves_end_at_their_axes() {
        let axis = |name| Axis {
            name,
            ends: (0.0, 10.0),
            marks: vec![(5.0, "five".to_owned())],
        };
        let line = vec![(-3.0, 0.0), (5.0, 20.0)];
        let svg = curves("title", [&axis("x"), &axis("y")], &["a"], &[line]);
        check(&svg);
        assert!(svg.contains("points=\"60.0,302.0 320.0,62.0\""), "{svg}");
        assert!(svg.contains("y against x"));
    }

    #[test]
    fn bars_and_grids_leave_out_what_is_not_there() {
        let rows = [
            Row {
                name: "one, two".to_owned(),
                values: vec![Some(1.0), None],
            },
            Row {
                name: "three".to_owned(),
                values: vec![Some(0.5), Some(9.0)],
            },
        ];
        let bars = bars("bars", &["x", "y"], &rows, 4.0, &[2.0]);
        check(&bars);
        assert_eq!(
            bars.matches("<rect class=\"dot\"").count(),
            2 + 3,
            "legend and bars"
        );
        assert!(bars.contains(">9</text>"), "beyond the scale");
        assert_eq!(bars.matches("class=\"aim\"").count(), 1);
        let grid = grid("grid", &["x, y", "z"], &rows[..1]);
        check(&grid);
        assert_eq!(grid.matches("<rect class=\"dot\"").count(), 1);
        assert!(grid.contains("100 %"));
    }
}
