//! The types that a tuned constant can have, read and written as `f32`.

/// A value of a tuned constant.
pub(super) trait Value {
    /// Returns the value.
    fn get(&self) -> f32;
    /// Sets the value. Returns false, and sets nothing, if this type cannot hold it.
    fn set(&mut self, value: f32) -> bool;
}

impl Value for f32 {
    fn get(&self) -> f32 {
        *self
    }

    fn set(&mut self, value: f32) -> bool {
        *self = value;
        true
    }
}

macro_rules! whole {
    ($($type:ty)*) => {$(
        impl Value for $type {
            fn get(&self) -> f32 {
                *self as f32
            }

            fn set(&mut self, value: f32) -> bool {
                // A cast saturates, so the way back shows if the value was whole and in range.
                let whole = value as Self;
                let fits = whole as f32 == value;
                if fits {
                    *self = whole;
                }
                fits
            }
        }
    )*};
}

whole!(u8 u16 u32 i32 usize);
