//! SVG as a backend of plotters. Beside plotters' own words it knows what SVG does better than they: dashes, closed outlines, and groups
//! with a class and a title that a viewer shows on hover.
//!
//! Coordinates are integers, as plotters' are; each is a tenth of a pixel, and the viewBox shrinks them. Paths step from point to point.
//! An attribute that most shapes of a group share stands at the group. The same calls always give the same bytes.

use std::collections::BTreeMap;
use std::fmt::{Error, Write};

use plotters_backend::text_anchor::{HPos, VPos};
use plotters_backend::{
    BackendColor, BackendCoord, BackendStyle, BackendTextStyle, DrawingBackend, DrawingErrorKind, FontStyle,
    FontTransform,
};

use crate::draw::text::{printable, text_width};

/// Units of the backend to a logical pixel.
pub const SCALE: f64 = 10.0;

/// Height of a capital letter in em, and of what stands above and below the baseline.
const CAPITAL: f64 = 0.72;
const ABOVE: f64 = 0.76;
const BELOW: f64 = 0.24;

/// Presentation attributes of a shape, each with its value.
type Look = BTreeMap<&'static str, String>;

/// What the backend answers.
type Drawn = Result<(), DrawingErrorKind<Error>>;

/// A shape as an element without parts.
struct SvgShape {
    tag: &'static str,
    /// Where it lies.
    place: Vec<(&'static str, String)>,
    look: Look,
    words: String,
}

/// Shapes that belong together.
#[derive(Default)]
struct Group {
    class: &'static str,
    title: String,
    parts: Vec<Part>,
}

enum Part {
    SvgShape(SvgShape),
    Group(Group),
}

/// A figure in the making. [`DrawingBackend::present`] writes it.
pub struct Svg<'a> {
    out: &'a mut String,
    /// Width and height in units.
    size: (u32, u32),
    /// Groups that are open, each in the one before; the first is the figure.
    open: Vec<Group>,
    /// Lengths of strokes and gaps of the lines to come, in units; none for unbroken lines.
    dashes: Vec<u32>,
}

impl<'a> Svg<'a> {
    /// A figure of this width and height in units that will be written to `out`.
    pub fn with_string(out: &'a mut String, size: (u32, u32)) -> Self {
        Self { out, size, open: vec![Group::default()], dashes: Vec::new() }
    }

    /// Sets the lengths of strokes and gaps, in units, for the lines to come; none for unbroken lines.
    pub fn set_dashes(&mut self, lengths: impl IntoIterator<Item = u32>) {
        self.dashes = lengths.into_iter().collect();
    }

    /// Opens a group; a title is shown on hover over any of its shapes, an empty one is left out.
    pub fn open_group(&mut self, class: &'static str, title: &str) {
        self.open.push(Group { class, title: title.to_owned(), parts: Vec::new() });
    }

    /// Closes the group opened last. Without an open group nothing happens.
    pub fn close_group(&mut self) {
        if self.open.len() < 2 {
            return;
        }
        if let Some(group) = self.open.pop().filter(|g| !g.parts.is_empty()) {
            self.add(Part::Group(group));
        }
    }

    /// Draws a line through the points and back to the first.
    pub fn draw_outline<S: BackendStyle>(
        &mut self,
        points: impl IntoIterator<Item = BackendCoord>,
        style: &S,
    ) {
        self.stroke(path(points, true), style);
    }

    /// Draws a filled circle with a rim of this style. Radius in units.
    pub fn draw_ring<S: BackendStyle>(
        &mut self,
        center: BackendCoord,
        radius: u32,
        fill: BackendColor,
        style: &S,
    ) {
        let mut look = filled(fill);
        look.extend(
            stroked(style, "none".to_owned()).into_iter().filter(|(name, _)| !name.starts_with("fill")),
        );
        self.circle(center, radius, look);
    }

    fn add(&mut self, part: Part) {
        if let Some(group) = self.open.last_mut() {
            group.parts.push(part);
        }
    }

    fn circle(&mut self, (x, y): BackendCoord, radius: u32, look: Look) {
        let place = vec![("cx", x.to_string()), ("cy", y.to_string()), ("r", radius.to_string())];
        self.add(Part::SvgShape(SvgShape { tag: "circle", place, look, words: String::new() }));
    }

    /// Lines that follow one another in the same look become one path.
    fn stroke<S: BackendStyle>(&mut self, d: String, style: &S) {
        if style.color().alpha == 0.0 {
            return;
        }
        let lengths: Vec<String> = self.dashes.iter().map(u32::to_string).collect();
        let dashes = if lengths.is_empty() { "none".to_owned() } else { lengths.join(" ") };
        let look = stroked(style, dashes);
        let last = self.open.last_mut().and_then(|group| group.parts.last_mut());
        if let Some(Part::SvgShape(before)) = last
            && before.look == look
            && let ("path", [(_, line)]) = (before.tag, &mut before.place[..])
        {
            line.push_str(&d);
            return;
        }
        self.add(Part::SvgShape(SvgShape { tag: "path", place: vec![("d", d)], look, words: String::new() }));
    }

    fn fill(&mut self, d: String, color: BackendColor) {
        if color.alpha > 0.0 {
            let place = vec![("d", d)];
            self.add(Part::SvgShape(SvgShape {
                tag: "path",
                place,
                look: filled(color),
                words: String::new(),
            }));
        }
    }
}

impl DrawingBackend for Svg<'_> {
    type ErrorType = Error;

    fn get_size(&self) -> (u32, u32) {
        self.size
    }

    fn ensure_prepared(&mut self) -> Drawn {
        Ok(())
    }

    /// Writes all that was drawn; what was written before is replaced.
    fn present(&mut self) -> Drawn {
        while self.open.len() > 1 {
            self.close_group();
        }
        self.out.clear();
        let (width, height) = self.size;
        let [shown_width, shown_height] = [width, height].map(|units| f64::from(units) / SCALE);
        let mut write = || {
            write!(
                self.out,
                "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{shown_width}\" height=\"{shown_height}\" \
                 viewBox=\"0 0 {width} {height}\" stroke-linejoin=\"round\""
            )?;
            self.open.iter().try_for_each(|figure| write_parts(self.out, figure, &Look::new()))?;
            self.out.write_str("</svg>\n")
        };
        write().map_err(DrawingErrorKind::DrawingError)
    }

    fn draw_pixel(&mut self, (x, y): BackendCoord, color: BackendColor) -> Drawn {
        self.fill(rectangle((x, y), (x.saturating_add(1), y.saturating_add(1))), color);
        Ok(())
    }

    fn draw_line<S: BackendStyle>(&mut self, from: BackendCoord, to: BackendCoord, style: &S) -> Drawn {
        self.stroke(path([from, to], false), style);
        Ok(())
    }

    fn draw_rect<S: BackendStyle>(
        &mut self,
        upper_left: BackendCoord,
        bottom_right: BackendCoord,
        style: &S,
        fill: bool,
    ) -> Drawn {
        let d = rectangle(upper_left, bottom_right);
        if fill {
            self.fill(d, style.color())
        } else {
            self.stroke(d, style)
        }
        Ok(())
    }

    fn draw_path<S: BackendStyle, I: IntoIterator<Item = BackendCoord>>(
        &mut self,
        points: I,
        style: &S,
    ) -> Drawn {
        self.stroke(path(points, false), style);
        Ok(())
    }

    fn draw_circle<S: BackendStyle>(
        &mut self,
        center: BackendCoord,
        radius: u32,
        style: &S,
        fill: bool,
    ) -> Drawn {
        if style.color().alpha > 0.0 {
            let look = if fill { filled(style.color()) } else { stroked(style, "none".to_owned()) };
            self.circle(center, radius, look);
        }
        Ok(())
    }

    fn fill_polygon<S: BackendStyle, I: IntoIterator<Item = BackendCoord>>(
        &mut self,
        points: I,
        style: &S,
    ) -> Drawn {
        self.fill(path(points, true), style.color());
        Ok(())
    }

    /// Writes text as text; the size of its style is the height of an em in units.
    fn draw_text<S: BackendTextStyle>(&mut self, text: &str, style: &S, (x, y): BackendCoord) -> Drawn {
        let words = printable(text);
        if words.trim().is_empty() || style.color().alpha == 0.0 {
            return Ok(());
        }
        let below = match style.anchor().v_pos {
            VPos::Top => ABOVE,
            VPos::Center => CAPITAL / 2.0,
            VPos::Bottom => -BELOW,
        };
        let transform = style.transform();
        // the baseline, turned with the text
        let (right, down) = transform.transform(0, (below * style.size()).round() as i32);
        let (x, y) = (x.saturating_add(right), y.saturating_add(down));
        let mut place = vec![("x", x.to_string()), ("y", y.to_string())];
        let angle = match transform {
            FontTransform::None => 0,
            FontTransform::Rotate90 => 90,
            FontTransform::Rotate180 => 180,
            FontTransform::Rotate270 => -90,
        };
        if angle != 0 {
            place.push(("transform", format!("rotate({angle} {x} {y})")));
        }
        let anchor = match style.anchor().h_pos {
            HPos::Left => "start",
            HPos::Center => "middle",
            HPos::Right => "end",
        };
        let (slant, weight) = match style.style() {
            FontStyle::Normal => ("normal", "normal"),
            FontStyle::Italic => ("italic", "normal"),
            FontStyle::Oblique => ("oblique", "normal"),
            FontStyle::Bold => ("normal", "bold"),
        };
        let mut look = filled(style.color());
        look.extend([
            ("font-family", style.family().as_str().to_owned()),
            ("font-size", decimal(style.size())),
            ("font-style", slant.to_owned()),
            ("font-weight", weight.to_owned()),
            ("text-anchor", anchor.to_owned()),
        ]);
        self.add(Part::SvgShape(SvgShape { tag: "text", place, look, words }));
        Ok(())
    }

    /// Width and height of a text in units, on the generous side: there is no font to measure.
    fn estimate_text_size<S: BackendTextStyle>(
        &self,
        text: &str,
        style: &S,
    ) -> Result<(u32, u32), DrawingErrorKind<Error>> {
        Ok((text_width(&printable(text), style.size()).ceil() as u32, style.size().ceil() as u32))
    }
}

/// Data of a path through the points: where it starts, then steps.
fn path(points: impl IntoIterator<Item = BackendCoord>, closed: bool) -> String {
    let mut d = String::new();
    let mut first: Option<BackendCoord> = None;
    let mut before: Option<(i64, i64)> = None;
    let mut command = ' ';
    let mut points = points.into_iter().peekable();
    while let Some(point) = points.next() {
        let (x, y) = (i64::from(point.0), i64::from(point.1));
        let (name, steps) = match before {
            None => ('M', [Some(x), Some(y)]),
            Some((a, b)) => match (x - a, y - b) {
                (0, 0) => continue,
                (right, 0) => ('h', [Some(right), None]),
                (0, down) => ('v', [None, Some(down)]),
                (right, down) => ('l', [Some(right), Some(down)]),
            },
        };
        // the way back to the start is what closing draws
        if closed && points.peek().is_none() && first == Some(point) {
            break;
        }
        if name != command {
            d.push(name);
            command = name;
        }
        for step in steps.into_iter().flatten() {
            if step >= 0 && d.ends_with(|c: char| c.is_ascii_digit()) {
                d.push(' ');
            }
            d.push_str(&step.to_string());
        }
        first = first.or(Some(point));
        before = Some((x, y));
    }
    if closed {
        d.push('z');
    }
    d
}

fn rectangle((left, top): BackendCoord, (right, bottom): BackendCoord) -> String {
    path([(left, top), (right, top), (right, bottom), (left, bottom)], true)
}

/// A length with at most two decimals.
fn decimal(value: f64) -> String {
    format!("{}", (100.0 * value).round() / 100.0)
}

fn hexadecimal(color: BackendColor) -> String {
    let (r, g, b) = color.rgb;
    let short = [r, g, b].iter().all(|c| c % 17 == 0);
    if short { format!("#{:X}{:X}{:X}", r / 17, g / 17, b / 17) } else { format!("#{r:02X}{g:02X}{b:02X}") }
}

fn filled(color: BackendColor) -> Look {
    Look::from([
        ("fill", hexadecimal(color)),
        ("fill-opacity", decimal(color.alpha)),
        ("stroke", "none".to_owned()),
    ])
}

fn stroked<S: BackendStyle>(style: &S, dashes: String) -> Look {
    Look::from([
        ("fill", "none".to_owned()),
        ("stroke", hexadecimal(style.color())),
        ("stroke-dasharray", dashes),
        ("stroke-opacity", decimal(style.color().alpha)),
        ("stroke-width", style.stroke_width().to_string()),
    ])
}

/// The value of an attribute that is written nowhere; there is none for families and sizes of fonts.
fn initial(attribute: &str) -> &'static str {
    match attribute {
        "fill" => "#000",
        "stroke" | "stroke-dasharray" => "none",
        "fill-opacity" | "stroke-opacity" | "stroke-width" => "1",
        "font-style" | "font-weight" => "normal",
        "text-anchor" => "start",
        _ => "",
    }
}

/// The value that holds inside groups with these attributes.
fn value<'l>(look: &'l Look, attribute: &str) -> &'l str {
    look.get(attribute).map_or(initial(attribute), String::as_str)
}

/// Counts the values of each attribute, in the order in which they occur.
fn count<'p>(parts: &'p [Part], counts: &mut BTreeMap<&'static str, Vec<(&'p str, usize)>>) {
    for part in parts {
        match part {
            Part::Group(group) => count(&group.parts, counts),
            Part::SvgShape(shape) => {
                for (&attribute, value) in &shape.look {
                    let values = counts.entry(attribute).or_default();
                    match values.iter_mut().find(|(known, _)| known == value) {
                        Some((_, number)) => *number += 1,
                        None => values.push((value, 1)),
                    }
                }
            }
        }
    }
}

/// Attributes that are shorter to write once at the group than at its shapes.
fn shared(parts: &[Part], inherited: &Look) -> Look {
    let mut counts = BTreeMap::new();
    count(parts, &mut counts);
    let mut look = Look::new();
    for (attribute, values) in counts {
        let before = value(inherited, attribute);
        let as_before = values.iter().find(|(v, _)| *v == before).map_or(0, |(_, number)| *number);
        let mut most = (before, as_before + 1);
        for (v, number) in values {
            if v != before && number > most.1 {
                most = (v, number);
            }
        }
        if most.0 != before {
            look.insert(attribute, most.0.to_owned());
        }
    }
    look
}

/// Ends the tag of a group with the attributes that its shapes share, and writes its title and its parts.
fn write_parts(out: &mut String, group: &Group, inherited: &Look) -> std::fmt::Result {
    let own = shared(&group.parts, inherited);
    for (attribute, value) in &own {
        write_attribute(out, attribute, value)?;
    }
    out.write_char('>')?;
    let title = printable(&group.title);
    if !title.trim().is_empty() {
        write!(out, "<title>{}</title>", escaped(title.trim()))?;
    }
    out.write_char('\n')?;
    let mut look = inherited.clone();
    look.extend(own);
    for part in &group.parts {
        match part {
            Part::Group(inside) => {
                out.write_str("<g")?;
                write_attribute(out, "class", inside.class)?;
                write_parts(out, inside, &look)?;
                out.write_str("</g>\n")?;
            }
            Part::SvgShape(shape) => write_shape(out, shape, &look)?,
        }
    }
    Ok(())
}

fn write_shape(out: &mut String, shape: &SvgShape, inherited: &Look) -> std::fmt::Result {
    write!(out, "<{}", shape.tag)?;
    for (attribute, value) in &shape.place {
        write_attribute(out, attribute, value)?;
    }
    for (&attribute, own) in &shape.look {
        if own != value(inherited, attribute) {
            write_attribute(out, attribute, own)?;
        }
    }
    if shape.words.is_empty() {
        out.write_str("/>\n")
    } else {
        writeln!(out, ">{}</{}>", escaped(&shape.words), shape.tag)
    }
}

fn write_attribute(out: &mut String, name: &str, value: &str) -> std::fmt::Result {
    write!(out, " {name}=\"{}\"", escaped(value))
}

/// The text with its markup told from that of the file.
fn escaped(text: &str) -> String {
    let mut safe = String::with_capacity(text.len());
    for character in text.chars() {
        match character {
            '&' => safe.push_str("&amp;"),
            '<' => safe.push_str("&lt;"),
            '>' => safe.push_str("&gt;"),
            '"' => safe.push_str("&quot;"),
            other => safe.push(other),
        }
    }
    safe
}
