//! Sources of sphere tables: a file, or arrays in the caller's memory.
//!
//! Memory is only referenced, through a shared owner, until the scene is built. Each table is then
//! read once into the scene's own storage and released before the next one is read.

use std::fmt;
use std::path::PathBuf;
use std::sync::Arc;

use serde::{Deserialize, Deserializer, Serialize, Serializer};

pub use super::colors::PackedColor;
pub use super::columns::{Column, FileColumn, NumberType};
use super::particle_file::ParticleTable;

/// The values of many spheres.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "type", rename_all = "kebab-case", deny_unknown_fields)]
#[allow(clippy::large_enum_variant, reason = "a scene has few of them")]
pub enum SphereData {
    /// A file of raw little-endian numbers, or a NumPy file.
    File {
        /// The file.
        #[serde(with = "super::paths")]
        path: PathBuf,
        /// Meaning and type of each number in a row. Empty for a NumPy array of records whose
        /// fields have the names of columns; the scene lists them.
        columns: Vec<FileColumn>,
        /// Number of rows that are left out at the beginning.
        #[serde(default, skip_serializing_if = "is_zero")]
        skip_rows: u64,
        /// Bytes before the first row of a raw file.
        #[serde(default, skip_serializing_if = "is_zero")]
        skip_bytes: u64,
    },
    /// Arrays in memory. Serialized only as the number of spheres and whether they have colours and
    /// emission.
    #[serde(serialize_with = "serialize_arrays", deserialize_with = "deserialize_arrays")]
    Memory(SphereArrays),
    /// The particles of a file in a format of other programs.
    Particles(Box<ParticleTable>),
}

/// Spheres as arrays in memory, each with its own type and layout. All arrays have the same length.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SphereArrays {
    /// Centres: x, y and z.
    pub center: [StridedArray; 3],
    /// Radii, in the unit of the centres.
    pub radius: StridedArray,
    /// Linear colours in `[0, 1]` (red, green, blue), which replace the material's colour.
    pub color: Option<[StridedArray; 3]>,
    /// Emitted radiance in W/(sr m^2) (red, green, blue), which replaces the material's emission.
    pub emission: Option<[StridedArray; 3]>,
    /// User-defined sphere ids, which replace the rows in the AOV `sphere_id` and in names. 2^32 -
    /// 1 means "no sphere" and is not allowed.
    pub ids: Option<StridedArray<Ids>>,
}

/// One number per sphere, at a constant stride in an array.
///
/// Offset and stride count elements. In a byte array, whose numbers may be unaligned, they count
/// bytes; this supports structured NumPy arrays whose row size is not a multiple of the number
/// size.
#[derive(Clone, Debug, PartialEq)]
pub struct StridedArray<A = ArrayValues> {
    /// The array.
    pub values: A,
    /// Index of the first sphere's number; in a byte array, of its first byte.
    pub offset: usize,
    /// Distance between consecutive numbers: 1 if contiguous, 4 in rows of four, 0 if all spheres
    /// share one number, negative if reversed.
    pub stride: isize,
    /// Number of spheres.
    pub len: usize,
}

/// An array of one type.
#[derive(Clone, Debug, PartialEq)]
pub enum ArrayValues {
    /// 32-bit floats.
    F32(SharedSlice<f32>),
    /// 64-bit floats, which are not rounded before the scene's origin is known.
    F64(SharedSlice<f64>),
    /// Little-endian 32-bit floats in a byte array.
    F32Bytes(SharedSlice<u8>),
    /// Little-endian 64-bit floats in a byte array, which are not rounded either.
    F64Bytes(SharedSlice<u8>),
    /// Linear colours in 32 bits. Offset and stride count channels, of which each colour has three.
    Packed(SharedSlice<PackedColor>),
}

/// An array of ids.
#[derive(Clone, Debug, PartialEq)]
pub enum Ids {
    /// 32-bit unsigned integers.
    U32(SharedSlice<u32>),
    /// Little-endian 32-bit unsigned integers in a byte array.
    U32Bytes(SharedSlice<u8>),
}

/// Memory with a shared owner: a `Vec`, or anything else that provides a slice.
pub struct SharedSlice<T>(Arc<dyn AsRef<[T]> + Send + Sync>);

impl Default for SphereData {
    /// No spheres.
    fn default() -> Self {
        Self::Memory(SphereArrays::default())
    }
}

impl SphereData {
    /// A whole file with these columns.
    pub fn file<C: Into<FileColumn>>(
        path: impl Into<PathBuf>,
        columns: impl IntoIterator<Item = C>,
    ) -> Self {
        let columns = columns.into_iter().map(Into::into).collect();
        Self::File { path: path.into(), columns, skip_rows: 0, skip_bytes: 0 }
    }

    /// Returns true if the spheres have colours of their own.
    pub fn has_colors(&self) -> bool {
        match self {
            Self::File { columns, .. } => has_any(columns, Column::is_color),
            Self::Memory(arrays) => arrays.color.is_some(),
            Self::Particles(_) => true,
        }
    }

    /// Returns true if the spheres have emission of their own.
    pub fn has_emission(&self) -> bool {
        match self {
            Self::File { columns, .. } => has_any(columns, Column::is_emission),
            Self::Memory(arrays) => arrays.emission.is_some(),
            Self::Particles(particles) => particles.appearance.glow > 0.0,
        }
    }

    /// Releases arrays in memory and keeps only their number of spheres.
    pub(super) fn let_go(&mut self) {
        if let Self::Memory(arrays) = self {
            *arrays = SphereArrays::placeholder(&ArraysSummary::of(arrays));
        }
    }
}

fn has_any(columns: &[FileColumn], is_wanted: impl Fn(Column) -> bool) -> bool {
    columns.iter().filter_map(|column| column.column).any(is_wanted)
}

fn is_zero(number: &u64) -> bool {
    *number == 0
}

impl SphereArrays {
    /// From rows of `[x, y, z, radius]` in f32.
    pub fn from_rows(rows: Vec<[f32; 4]>) -> Self {
        let len = rows.len();
        let values = ArrayValues::F32(SharedSlice::new(FlatRows(rows)));
        let column =
            |first: usize| StridedArray { values: values.clone(), offset: first, stride: 4, len };
        Self { center: [0, 1, 2].map(column), radius: column(3), ..Self::default() }
    }

    /// From centres and radii, in f32 or f64.
    pub fn from_centers<T: Scalar>(centers: Vec<[T; 3]>, radii: Vec<T>) -> Self {
        Self {
            center: StridedArray::columns_from(centers),
            radius: StridedArray::from_vec(radii),
            ..Self::default()
        }
    }

    /// Sets a linear colour for each sphere.
    #[must_use]
    pub fn with_colors<T: Scalar>(self, colors: Vec<[T; 3]>) -> Self {
        Self { color: Some(StridedArray::columns_from(colors)), ..self }
    }

    /// Sets the emitted radiance of each sphere, in W/(sr m^2).
    #[must_use]
    pub fn with_emission<T: Scalar>(self, emission: Vec<[T; 3]>) -> Self {
        Self { emission: Some(StridedArray::columns_from(emission)), ..self }
    }

    /// Sets an id for each sphere.
    #[must_use]
    pub fn with_ids(self, ids: Vec<u32>) -> Self {
        Self { ids: Some(StridedArray::of_ids(ids)), ..self }
    }

    /// Arrays without data. Their numbers are out of bounds, so no scene can be built from them.
    fn placeholder(
        &ArraysSummary { spheres: len, has_colors, has_emission }: &ArraysSummary,
    ) -> Self {
        let gone = || StridedArray { len, ..StridedArray::default() };
        let three = || std::array::from_fn(|_| gone());
        let (color, emission) = (has_colors.then(three), has_emission.then(three));
        Self { center: three(), radius: gone(), color, emission, ids: None }
    }

    /// Returns true if centres or radii are in f64.
    pub(super) fn is_f64(&self) -> bool {
        let Self { center: [x, y, z], radius, .. } = self;
        let is_f64 = |array: &&StridedArray| {
            matches!(array.values, ArrayValues::F64(_) | ArrayValues::F64Bytes(_))
        };
        [x, y, z, radius].iter().any(is_f64)
    }

    /// Number of spheres.
    pub fn len(&self) -> usize {
        self.radius.len
    }

    /// Returns true if there are no spheres.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Each array with its column.
    pub(super) fn columns<'a>(&'a self) -> impl Iterator<Item = (Column, &'a StridedArray)> {
        let three = |columns: [Column; 3], arrays: &'a Option<[StridedArray; 3]>| {
            arrays.iter().flat_map(move |arrays| columns.into_iter().zip(arrays))
        };
        let center = [Column::X, Column::Y, Column::Z].into_iter().zip(&self.center);
        center
            .chain([(Column::Radius, &self.radius)])
            .chain(three(Column::COLOR, &self.color))
            .chain(three(Column::EMISSION, &self.emission))
    }
}

impl StridedArray {
    /// From a contiguous array.
    pub fn from_vec<T: Scalar>(values: Vec<T>) -> Self {
        let len = values.len();
        Self { values: T::into_values(SharedSlice::new(values)), offset: 0, stride: 1, len }
    }

    /// The columns of an array of rows.
    pub fn columns_from<T: Scalar, const N: usize>(rows: Vec<[T; N]>) -> [Self; N] {
        let len = rows.len();
        let values = T::into_values(SharedSlice::new(FlatRows(rows)));
        std::array::from_fn(|first| Self {
            values: values.clone(),
            offset: first,
            stride: N as isize,
            len,
        })
    }

    /// The channels of packed colours.
    pub(super) fn packed(colors: Vec<PackedColor>) -> [Self; 3] {
        let len = colors.len();
        let values = ArrayValues::Packed(SharedSlice::new(colors));
        std::array::from_fn(|channel| Self {
            values: values.clone(),
            offset: channel,
            stride: 3,
            len,
        })
    }

    /// Returns true if the numbers are rounded colours.
    pub(super) fn is_packed(&self) -> bool {
        matches!(self.values, ArrayValues::Packed(_))
    }

    /// One shared number for all spheres.
    pub fn constant<T: Scalar>(value: T, len: usize) -> Self {
        Self { values: T::into_values(SharedSlice::new(vec![value])), offset: 0, stride: 0, len }
    }

    /// Returns true if every number lies within the array.
    pub(super) fn is_in_bounds(&self) -> bool {
        match &self.values {
            ArrayValues::F32(values) => self.is_within(values.as_slice().len(), 1),
            ArrayValues::F64(values) => self.is_within(values.as_slice().len(), 1),
            ArrayValues::F32Bytes(bytes) => {
                self.is_within(bytes.as_slice().len(), size_of::<f32>())
            }
            ArrayValues::F64Bytes(bytes) => {
                self.is_within(bytes.as_slice().len(), size_of::<f64>())
            }
            ArrayValues::Packed(colors) => self.is_within(3 * colors.as_slice().len(), 1),
        }
    }

    /// A reader for the numbers. Requires [`Self::is_in_bounds`].
    pub(super) fn reader(&self) -> Reader<'_> {
        let numbers = match &self.values {
            ArrayValues::F32(values) => Numbers::F32(values.as_slice()),
            ArrayValues::F64(values) => Numbers::F64(values.as_slice()),
            ArrayValues::F32Bytes(bytes) => Numbers::F32Bytes(bytes.as_slice()),
            ArrayValues::F64Bytes(bytes) => Numbers::F64Bytes(bytes.as_slice()),
            ArrayValues::Packed(colors) => Numbers::Packed(colors.as_slice()),
        };
        Reader { numbers, first: self.offset, stride: self.stride }
    }
}

impl StridedArray<Ids> {
    /// From a contiguous array of ids.
    pub fn of_ids(ids: Vec<u32>) -> Self {
        let len = ids.len();
        Self { values: Ids::U32(SharedSlice::new(ids)), offset: 0, stride: 1, len }
    }

    /// Returns true if every id lies within the array.
    pub(super) fn fits(&self) -> bool {
        match &self.values {
            Ids::U32(ids) => self.is_within(ids.as_slice().len(), 1),
            Ids::U32Bytes(bytes) => self.is_within(bytes.as_slice().len(), size_of::<u32>()),
        }
    }

    /// All ids in order. Requires [`Self::fits`].
    pub(super) fn iter(&self) -> impl Iterator<Item = u32> {
        let (words, bytes) = match &self.values {
            Ids::U32(ids) => (ids.as_slice(), &[][..]),
            Ids::U32Bytes(bytes) => (&[][..], bytes.as_slice()),
        };
        let in_bytes = matches!(self.values, Ids::U32Bytes(_));
        (0..self.len).map(move |row| match index(self.offset, self.stride, row) {
            at if in_bytes => u32::from_le_bytes(bytes_at(bytes, at)),
            at => words[at],
        })
    }
}

impl<A> StridedArray<A> {
    /// Returns true if every number, of size `each` in elements, lies within an array of
    /// `elements`.
    fn is_within(&self, elements: usize, each: usize) -> bool {
        let at = |row: i128| self.offset as i128 + row * self.stride as i128;
        let is_within = |index: i128| 0 <= index && index + each as i128 <= elements as i128;
        self.len == 0 || is_within(at(0)) && is_within(at(self.len as i128 - 1))
    }
}

/// Reads the numbers of a [`StridedArray`], with its memory looked up once.
pub(super) struct Reader<'a> {
    numbers: Numbers<'a>,
    first: usize,
    stride: isize,
}

enum Numbers<'a> {
    F32(&'a [f32]),
    F64(&'a [f64]),
    F32Bytes(&'a [u8]),
    F64Bytes(&'a [u8]),
    Packed(&'a [PackedColor]),
}

impl Reader<'_> {
    /// The number of a sphere; -0 becomes 0.
    #[inline]
    pub(super) fn get(&self, row: usize) -> f64 {
        let at = index(self.first, self.stride, row);
        let number = match self.numbers {
            Numbers::F32(values) => f64::from(values[at]),
            Numbers::F64(values) => values[at],
            Numbers::F32Bytes(bytes) => f64::from(f32::from_le_bytes(bytes_at(bytes, at))),
            Numbers::F64Bytes(bytes) => f64::from_le_bytes(bytes_at(bytes, at)),
            Numbers::Packed(colors) => f64::from(colors[at / 3].get()[at % 3]),
        };
        number + 0.0
    }
}

/// Array index of a row's number.
fn index(first: usize, stride: isize, row: usize) -> usize {
    first.wrapping_add_signed(stride.wrapping_mul(row as isize))
}

fn bytes_at<const N: usize>(bytes: &[u8], at: usize) -> [u8; N] {
    let mut number = [0; N];
    number.copy_from_slice(&bytes[at..at + N]);
    number
}

impl Default for StridedArray {
    fn default() -> Self {
        Self::from_vec(Vec::<f32>::new())
    }
}

/// f32 or f64.
pub trait Scalar: Copy + Send + Sync + 'static {
    /// Wraps an array of this type.
    fn into_values(array: SharedSlice<Self>) -> ArrayValues
    where
        Self: Sized;
}

impl Scalar for f32 {
    fn into_values(array: SharedSlice<Self>) -> ArrayValues {
        ArrayValues::F32(array)
    }
}

impl Scalar for f64 {
    fn into_values(array: SharedSlice<Self>) -> ArrayValues {
        ArrayValues::F64(array)
    }
}

/// Rows viewed as one flat array.
struct FlatRows<T, const N: usize>(Vec<[T; N]>);

impl<T, const N: usize> AsRef<[T]> for FlatRows<T, N> {
    fn as_ref(&self) -> &[T] {
        self.0.as_flattened()
    }
}

impl<T> SharedSlice<T> {
    /// Shares the memory that `owner` provides for as long as it lives.
    pub fn new(owner: impl AsRef<[T]> + Send + Sync + 'static) -> Self {
        Self(Arc::new(owner))
    }

    /// The memory as a slice.
    pub fn as_slice(&self) -> &[T] {
        (*self.0).as_ref()
    }
}

impl<T> Clone for SharedSlice<T> {
    fn clone(&self) -> Self {
        Self(Arc::clone(&self.0))
    }
}

impl<T> fmt::Debug for SharedSlice<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} elements", self.as_slice().len())
    }
}

/// True for the same memory or equal elements.
impl<T: PartialEq> PartialEq for SharedSlice<T> {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0) || self.as_slice() == other.as_slice()
    }
}

/// Serialized form of arrays.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct ArraysSummary {
    spheres: usize,
    has_colors: bool,
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    has_emission: bool,
}

impl ArraysSummary {
    fn of(arrays: &SphereArrays) -> Self {
        let (has_colors, has_emission) = (arrays.color.is_some(), arrays.emission.is_some());
        Self { spheres: arrays.len(), has_colors, has_emission }
    }
}

fn serialize_arrays<S: Serializer>(arrays: &SphereArrays, to: S) -> Result<S::Ok, S::Error> {
    ArraysSummary::of(arrays).serialize(to)
}

fn deserialize_arrays<'de, D: Deserializer<'de>>(from: D) -> Result<SphereArrays, D::Error> {
    ArraysSummary::deserialize(from).map(|summary| SphereArrays::placeholder(&summary))
}
