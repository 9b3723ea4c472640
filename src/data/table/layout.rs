//! The places of the numbers in the bytes of a table, and their decoding.

use std::{f64::consts::PI, ops::Range};

use glam::DVec3;
use half::f16;

use crate::{
    data::table::{kind::RowKind, request::Defaults},
    tracer::{
        error::GeometryError,
        shape::{Shape, cylinder::Cylinder, sphere::Sphere},
        transform::Transform,
    },
};

/// The storage type of a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Scalar {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    I64,
    U64,
    F16,
    F32,
    F64,
    /// A byte that is not 0 is 1.
    Bool,
}

/// Decodes a number at the start of some bytes.
macro_rules! decoded {
    ($type:ty, $bytes:expr, $endian:expr) => {{
        let bytes = *$bytes.first_chunk()?;
        match $endian {
            Endian::Little => <$type>::from_le_bytes(bytes),
            Endian::Big => <$type>::from_be_bytes(bytes),
        }
    }};
}

impl Scalar {
    pub(crate) const fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 | Self::Bool => 1,
            Self::I16 | Self::U16 | Self::F16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::I64 | Self::U64 | Self::F64 => 8,
        }
    }

    /// Returns true if all numbers of the type are integers.
    pub(crate) const fn is_integer(self) -> bool {
        !matches!(self, Self::F16 | Self::F32 | Self::F64)
    }

    /// Decodes the number at the start of `bytes`. An f64 holds each of these types exactly, except
    /// integers of 64 bits beyond 2^53, which are rounded to the nearest.
    #[inline(always)]
    pub(crate) fn number(self, bytes: &[u8], endian: Endian) -> Option<f64> {
        Some(match self {
            Self::I8 => f64::from(decoded!(i8, bytes, endian)),
            Self::U8 => f64::from(decoded!(u8, bytes, endian)),
            Self::I16 => f64::from(decoded!(i16, bytes, endian)),
            Self::U16 => f64::from(decoded!(u16, bytes, endian)),
            Self::I32 => f64::from(decoded!(i32, bytes, endian)),
            Self::U32 => f64::from(decoded!(u32, bytes, endian)),
            Self::I64 => decoded!(i64, bytes, endian) as f64,
            Self::U64 => decoded!(u64, bytes, endian) as f64,
            Self::F16 => f64::from(decoded!(f16, bytes, endian)),
            Self::F32 => f64::from(decoded!(f32, bytes, endian)),
            Self::F64 => decoded!(f64, bytes, endian),
            Self::Bool => f64::from(*bytes.first()? != 0),
        })
    }

    /// Returns the number at the start of `bytes` as text, with the digits of its own type.
    pub(super) fn text(self, bytes: &[u8], endian: Endian) -> Option<String> {
        Some(match self {
            Self::I64 => decoded!(i64, bytes, endian).to_string(),
            Self::U64 => decoded!(u64, bytes, endian).to_string(),
            Self::F16 => format!("{:?}", decoded!(f16, bytes, endian)),
            Self::F32 => format!("{:?}", decoded!(f32, bytes, endian)),
            Self::F64 => format!("{:?}", decoded!(f64, bytes, endian)),
            Self::Bool => (*bytes.first()? != 0).to_string(),
            _ => self.number(bytes, endian)?.to_string(),
        })
    }
}

/// The byte order of a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Endian {
    Little,
    Big,
}

/// The place of a column's numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Column {
    /// Numbers in the bytes of the table.
    Stored {
        scalar: Scalar,
        endian: Endian,
        /// The offset of the first number.
        start: usize,
        /// The distance from one number to the next.
        step: usize,
        /// The divisor of all numbers.
        divisor: f64,
    },
    /// One number for all rows.
    Constant(f64),
}

impl Column {
    /// Returns how many numbers are complete in the first `bytes` bytes.
    const fn among(self, bytes: usize) -> usize {
        match self {
            Self::Constant(_) => usize::MAX,
            Self::Stored {
                scalar,
                start,
                step,
                ..
            } => match bytes.checked_sub(start) {
                Some(bytes) if bytes >= scalar.size() => (bytes - scalar.size()) / step + 1,
                _ => 0,
            },
        }
    }

    /// Decodes the numbers of some rows.
    fn decode(self, bytes: &[u8], rows: &Range<usize>, numbers: &mut Vec<f64>) {
        numbers.clear();
        let (scalar, endian, start, step, divisor) = match self {
            Self::Constant(number) => return numbers.resize(rows.len(), number),
            Self::Stored {
                scalar,
                endian,
                start,
                step,
                divisor,
            } => (scalar, endian, start, step, divisor),
        };
        let start = start + rows.start * step;
        let bytes = bytes.get(start..).unwrap_or_default();
        let cells = bytes.chunks_exact(step).take(rows.len());
        // Type and byte order are constants in each of these loops.
        macro_rules! decode {
            ($scalar:ident) => {{
                let number =
                    |cell, endian| Scalar::$scalar.number(cell, endian).unwrap_or_default();
                match endian {
                    Endian::Little => {
                        numbers.extend(cells.map(|cell| number(cell, Endian::Little)))
                    }
                    Endian::Big => numbers.extend(cells.map(|cell| number(cell, Endian::Big))),
                }
                // After the last cell of the table there may be fewer bytes than between two cells.
                if numbers.len() < rows.len() {
                    let last = bytes.get(numbers.len() * step..).unwrap_or_default();
                    numbers.push(number(last, endian));
                }
            }};
        }
        match scalar {
            Scalar::I8 => decode!(I8),
            Scalar::U8 => decode!(U8),
            Scalar::I16 => decode!(I16),
            Scalar::U16 => decode!(U16),
            Scalar::I32 => decode!(I32),
            Scalar::U32 => decode!(U32),
            Scalar::I64 => decode!(I64),
            Scalar::U64 => decode!(U64),
            Scalar::F16 => decode!(F16),
            Scalar::F32 => decode!(F32),
            Scalar::F64 => decode!(F64),
            Scalar::Bool => decode!(Bool),
        }
        if divisor != 1.0 {
            numbers.iter_mut().for_each(|number| *number /= divisor);
        }
    }
}

/// The number of rows and the places of their numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Layout {
    pub(super) kind: RowKind,
    pub(super) rows: usize,
    /// `None` if neither the table nor the scene gives it.
    pub(super) columns: Columns<Option<Column>>,
}

/// One for each of x, y and z, the x, y and z of the other end of a cylinder or of the axis of a copy,
/// the radius or the scale, red, green, blue, and the value that determines the color or the angle of a
/// copy.
pub(crate) type Columns<T> = [T; VALUE + 1];

/// The coordinates of the other end among the columns.
pub(super) const OTHER_END: Range<usize> = 3..RADIUS;
/// The radius among the columns.
pub(super) const RADIUS: usize = 6;
/// The channels of the color among the columns.
pub(crate) const COLORS: Range<usize> = 7..VALUE;
/// The value that determines the color among the columns.
pub(crate) const VALUE: usize = 10;

/// Number of rows decoded at once: few enough to stay in the nearest cache.
pub(super) const BLOCK: usize = 512;

/// Some decoded rows of a table, by column.
pub(super) struct Block {
    /// The index of the first row.
    pub(super) first: usize,
    pub(super) columns: Columns<Vec<f64>>,
}

impl Block {
    /// Creates a block without rows, before the first row of a table.
    pub(super) const fn new() -> Self {
        Self {
            first: 0,
            columns: [const { Vec::new() }; VALUE + 1],
        }
    }

    /// The center of each sphere, or the first end of each cylinder.
    pub(super) fn points(&self) -> impl Iterator<Item = DVec3> {
        let [x, y, z, ..] = &self.columns;
        points(x, y, z)
    }

    /// The other end of each cylinder.
    pub(super) fn other_ends(&self) -> impl Iterator<Item = DVec3> {
        let [_, _, _, x, y, z, ..] = &self.columns;
        points(x, y, z)
    }

    /// Each row as the shape that it stands for.
    #[inline]
    pub(super) fn rows(&self, kind: RowKind) -> impl Iterator<Item = Row> {
        let [.., radius, r, g, b, _] = &self.columns;
        let colors = r.iter().zip(g).zip(b).map(|((r, g), b)| [*r, *g, *b]);
        let mut other_ends = self.other_ends();
        let mut values = self.values().iter().copied();
        let rows = self.points().zip(radius).zip(colors).enumerate();
        rows.map(move |(at, ((point, radius), color))| Row {
            index: self.first + at,
            shape: match kind {
                RowKind::Sphere => Sphere::new(point, *radius).map(Shape::from),
                RowKind::Cylinder { capped } => {
                    let other = other_ends.next().unwrap_or(point);
                    Cylinder::new(point, other, *radius, capped).map(Shape::from)
                }
                // A copy is no shape without what it is a copy of.
                RowKind::Copy => Err(GeometryError::NoOperand),
            },
            color,
            value: values.next(),
        })
    }

    /// Each row as the place, the direction and the size of a copy.
    pub(super) fn transforms(&self) -> impl Iterator<Item = Result<Transform, GeometryError>> {
        let mut axes = self.other_ends();
        let mut angles = self.values().iter();
        let rows = self.points().zip(&self.columns[RADIUS]);
        rows.map(move |(shift, scale)| {
            let axis = axes.next().unwrap_or(DVec3::Y);
            let rotate = angles.next().map(|angle| (axis, angle * (PI / 180.0)));
            Transform::new(shift, rotate, DVec3::splat(*scale))
        })
    }

    /// The value of each row that determines its color, or the angle of each copy; none if there are
    /// none.
    pub(super) fn values(&self) -> &[f64] {
        &self.columns[VALUE]
    }
}

fn points(x: &[f64], y: &[f64], z: &[f64]) -> impl Iterator<Item = DVec3> {
    let all = x.iter().zip(y).zip(z);
    all.map(|((x, y), z)| DVec3::new(*x, *y, *z))
}

/// A decoded row of a table.
pub(crate) struct Row {
    /// The index, from 0.
    pub(crate) index: usize,
    /// The shape that it stands for.
    pub(crate) shape: Result<Shape, GeometryError>,
    pub(crate) color: [f64; 3],
    /// The value that determines the color, if one does.
    pub(crate) value: Option<f64>,
}

impl Layout {
    /// The columns of a file, and the defaults for those that it does not have.
    pub(super) fn new(rows: usize, stored: Columns<Option<Column>>, defaults: &Defaults) -> Self {
        let mut columns = stored;
        for (column, given) in columns.iter_mut().zip(defaults.numbers()) {
            *column = column.or(given.map(Column::Constant));
        }
        Self {
            kind: defaults.kind,
            rows,
            columns,
        }
    }

    /// The same for a file that has some of the columns; `column` gets the index among these.
    pub(super) fn some(
        rows: usize,
        has: Columns<bool>,
        defaults: &Defaults,
        column: impl Fn(usize) -> Column,
    ) -> Self {
        let mut count = 0;
        let stored = has.map(|has| {
            count += usize::from(has);
            has.then(|| column(count - 1))
        });
        Self::new(rows, stored, defaults)
    }

    /// Decodes the rows after those of `block`; `bytes` may be only the first bytes of the table.
    /// Returns false if these rows are not complete yet, or there are no more. A missing radius or
    /// color is 0; other missing columns are left out.
    pub(super) fn next(&self, bytes: &[u8], block: &mut Block) -> bool {
        let missing = Column::Constant(0.0);
        let columns = self.columns.map(|column| column.unwrap_or(missing));
        let [x, ..] = &block.columns;
        let first = block.first + x.len();
        let rows = first..self.rows.min(first + BLOCK);
        let have_come = |column: Column| column.among(bytes.len()) >= rows.end;
        if rows.is_empty() || !columns.into_iter().all(have_come) {
            return false;
        }
        block.first = first;
        for (at, (column, numbers)) in columns.into_iter().zip(&mut block.columns).enumerate() {
            // Most tables have neither, and every number costs.
            let is_rare = OTHER_END.contains(&at) || at == VALUE;
            if !is_rare || self.columns[at].is_some() {
                column.decode(bytes, &rows, numbers);
            }
        }
        true
    }
}
