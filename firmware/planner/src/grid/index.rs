//! The accessors that replace indexing. None of them can panic in the firmware.
//!
//! | accessor | outside |
//! | --- | --- |
//! | [`at`] | 0 by meaning: nothing is set beyond a plane |
//! | [`inside`], [`inside_mut`] | a bug: `None`; a test build panics |
//! | [`masked`], [`masked_mut`] | a bug: taken mod 2ᵏ; a test build panics |
//! | [`wrapped`], [`wrapped_mut`] | taken mod 2ᵏ: the array is a ring |
//!
//! The arrays of the last two rows have 2ᵏ elements.

/// Returns the element at an index, 0 outside.
#[inline(always)]
pub(crate) fn at<T: Copy + Default>(slice: &[T], index: usize) -> T {
    slice.get(index).copied().unwrap_or_default()
}

/// Returns the element at an index inside the slice.
#[inline(always)]
#[track_caller]
pub(crate) fn inside<T>(slice: &[T], index: usize) -> Option<&T> {
    debug_assert!(index < slice.len(), "{index} of {}", slice.len());
    slice.get(index)
}

/// Returns the element at an index inside the slice.
#[inline(always)]
#[track_caller]
pub(crate) fn inside_mut<T>(slice: &mut [T], index: usize) -> Option<&mut T> {
    debug_assert!(index < slice.len(), "{index} of {}", slice.len());
    slice.get_mut(index)
}

/// Returns the element at an index inside an array whose length is a power of two.
#[inline(always)]
#[track_caller]
pub(crate) const fn masked<T, const N: usize>(array: &[T; N], index: usize) -> &T {
    debug_assert!(index < N);
    wrapped(array, index)
}

/// Returns the element at an index inside an array whose length is a power of two.
#[inline(always)]
#[track_caller]
pub(crate) const fn masked_mut<T, const N: usize>(array: &mut [T; N], index: usize) -> &mut T {
    debug_assert!(index < N);
    wrapped_mut(array, index)
}

/// Returns the element at an index mod N; N is a power of two.
#[inline(always)]
#[allow(clippy::indexing_slicing, reason = "the mask keeps the index below N")]
pub(crate) const fn wrapped<T, const N: usize>(array: &[T; N], index: usize) -> &T {
    const { assert!(N.is_power_of_two()) };
    &array[index & (N - 1)]
}

/// Returns the element at an index mod N; N is a power of two.
#[inline(always)]
#[allow(clippy::indexing_slicing, reason = "the mask keeps the index below N")]
pub(crate) const fn wrapped_mut<T, const N: usize>(array: &mut [T; N], index: usize) -> &mut T {
    const { assert!(N.is_power_of_two()) };
    &mut array[index & (N - 1)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ring_wraps_below_zero_and_above_its_end() {
        let mut ring = [1, 2, 3, 4];
        *wrapped_mut(&mut ring, 5) = 7;
        assert_eq!([-1_i32, 5].map(|i| *wrapped(&ring, i as usize)), [4, 7]);
    }

    #[test]
    #[cfg(debug_assertions)]
    #[should_panic = "3 of 3"]
    fn an_index_outside_a_slice_is_a_bug() {
        inside(&[1, 2, 3], 3);
    }

    #[test]
    #[cfg(debug_assertions)]
    #[should_panic = "index < N"]
    fn an_index_outside_an_array_is_a_bug() {
        masked(&[1, 2, 3, 4], 4);
    }
}
