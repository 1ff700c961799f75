//! From one trajectory's numbers to lanes and back.
//!
//! A structure of numbers, `Case<f64>`, becomes a structure of lanes, `Case<F64x8>`, field by field: every parameter is
//! a lane, so trajectories with different masses, gains or starts share one batch.

use crate::number::{Mat3, Quat, Real, Vec3};

/// A value that exists once per trajectory and, lane by lane, for a batch of them.
pub trait Batch<R: Real>: Copy {
    /// The value of a single trajectory.
    type One: Copy + 'static;

    /// Lane `i` becomes `pick(i)`. Choices that are no numbers (which law flies) must agree between lanes.
    fn gather<'a>(pick: &dyn Fn(usize) -> &'a Self::One) -> Self;

    /// The value in lane `i`.
    fn scatter(&self, i: usize) -> Self::One;

    /// Lane by lane: `yes` where the mask holds, else `no`.
    fn choose(mask: R::Mask, yes: &Self, no: &Self) -> Self;
}

impl<R: Real> Batch<R> for R {
    type One = f64;

    fn gather<'a>(pick: &dyn Fn(usize) -> &'a f64) -> Self {
        R::from_fn(|i| *pick(i))
    }

    fn scatter(&self, i: usize) -> f64 {
        self.lane(i)
    }

    #[inline(always)]
    fn choose(mask: R::Mask, yes: &Self, no: &Self) -> Self {
        R::select(mask, *yes, *no)
    }
}

macro_rules! batch_of_components {
    ($($name:ident),*) => {$(
        impl<R: Real> Batch<R> for $name<R> {
            type One = $name<f64>;

            fn gather<'a>(pick: &dyn Fn(usize) -> &'a $name<f64>) -> Self {
                $name::from_lanes(|i| *pick(i))
            }

            fn scatter(&self, i: usize) -> $name<f64> {
                self.lane(i)
            }

            #[inline(always)]
            fn choose(mask: R::Mask, yes: &Self, no: &Self) -> Self {
                $name::select(mask, *yes, *no)
            }
        }
    )*};
}
batch_of_components!(Vec3, Quat, Mat3);

/// Declares a structure generic over the number type and implements [`Batch`] for it, field by field.
#[macro_export]
macro_rules! batch_struct {
    ($(#[$meta:meta])* pub struct $name:ident<R> { $($(#[$field_meta:meta])* pub $field:ident: $type:ty,)* }) => {
        $(#[$meta])*
        #[derive(Clone, Copy, Debug, PartialEq)]
        pub struct $name<R> { $($(#[$field_meta])* pub $field: $type,)* }

        impl<R: $crate::number::Real> $crate::batch::Batch<R> for $name<R> {
            type One = $name<f64>;

            fn gather<'a>(pick: &dyn Fn(usize) -> &'a $name<f64>) -> Self {
                Self { $($field: <$type as $crate::batch::Batch<R>>::gather(&|i| &pick(i).$field),)* }
            }

            fn scatter(&self, i: usize) -> $name<f64> {
                $name { $($field: <$type as $crate::batch::Batch<R>>::scatter(&self.$field, i),)* }
            }

            #[inline(always)]
            fn choose(mask: R::Mask, yes: &Self, no: &Self) -> Self {
                Self { $($field: <$type as $crate::batch::Batch<R>>::choose(mask, &yes.$field, &no.$field),)* }
            }
        }
    };
}

#[cfg(test)]
mod tests;
