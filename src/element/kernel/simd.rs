//! Working memory of the force kernels, cut into SIMD registers.

use pulp::bytemuck::{Pod, cast_slice_mut};

/// Floats of the widest register: stations are padded to a multiple of it.
pub const LANES: usize = 8;

/// Working memory, one for each thread. It starts on a cache line: a register that straddles two takes twice the time.
#[derive(Debug, Clone, Default)]
pub struct Scratch {
    values: Vec<f64>,
}

impl Scratch {
    /// `count` values: what an earlier use, if it took as many or more, has left there.
    pub(in crate::element) fn take(&mut self, count: usize) -> &mut [f64] {
        const LINE: usize = 64;
        let needed = count + LINE / size_of::<f64>();
        if self.values.len() < needed {
            self.values.resize(needed, 0.0);
        }
        let start = self.values.as_ptr().align_offset(LINE);
        &mut self.values[start..start + count]
    }
}

/// Takes `count` values of a type made of floats from the front of a pool.
#[inline(always)]
pub(in crate::element) fn take<'a, T: Pod>(pool: &mut &'a mut [f64], count: usize) -> &'a mut [T] {
    let (front, rest) = std::mem::take(pool).split_at_mut(count * size_of::<T>() / size_of::<f64>());
    *pool = rest;
    cast_slice_mut(front)
}
