//! From one trajectory's numbers to lanes and back.
//!
//! A structure of numbers, `Case<f64>`, becomes a structure of lanes, `Case<F64x8>`, field by field: every parameter is
//! a lane, so trajectories with different masses, gains or starts share one batch.

use crate::number::{Mat3, Quat, Real, Vec3};

/// A value that exists once per trajectory and, lane by lane, for a batch of them.
pub trait Batch<R: Real>: Copy {
    /// The value of a single trajectory.
    type One: Copy + 'static;

    /// The same value in every lane.
    fn same(one: &Self::One) -> Self;

    /// Gives lane `i` another value. Choices that are no numbers (which law flies) must agree between lanes.
    fn put(&mut self, i: usize, one: &Self::One);

    /// The value in lane `i`.
    fn scatter(&self, i: usize) -> Self::One;

    /// Lane by lane: `yes` where the mask holds, else `no`.
    fn choose(mask: R::Mask, yes: &Self, no: &Self) -> Self;

    /// Lane `i` becomes `pick(i)`.
    fn gather<'a>(pick: &dyn Fn(usize) -> &'a Self::One) -> Self {
        let mut lanes = Self::same(pick(0));
        for i in 1..R::LANES {
            lanes.put(i, pick(i));
        }
        lanes
    }
}

impl<R: Real> Batch<R> for R {
    type One = f64;

    fn same(one: &f64) -> Self {
        R::splat(*one)
    }

    fn put(&mut self, i: usize, one: &f64) {
        self.set_lane(i, *one);
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

            fn same(one: &$name<f64>) -> Self {
                $name::from_f64(one.0)
            }

            fn put(&mut self, i: usize, one: &$name<f64>) {
                self.set_lane(i, *one);
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

/// A few values side by side.
impl<R: Real, B: Batch<R>, const N: usize> Batch<R> for [B; N] {
    type One = [B::One; N];

    fn same(one: &Self::One) -> Self {
        core::array::from_fn(|k| B::same(&one[k]))
    }

    fn put(&mut self, i: usize, one: &Self::One) {
        for (lanes, one) in self.iter_mut().zip(one) {
            lanes.put(i, one);
        }
    }

    fn scatter(&self, i: usize) -> Self::One {
        core::array::from_fn(|k| self[k].scatter(i))
    }

    #[inline(always)]
    fn choose(mask: R::Mask, yes: &Self, no: &Self) -> Self {
        let mut chosen = *no;
        for k in 0..N {
            chosen[k] = B::choose(mask, &yes[k], &no[k]);
        }
        chosen
    }
}

/// What all lanes have, or none.
impl<R: Real, B: Batch<R>> Batch<R> for Option<B> {
    type One = Option<B::One>;

    fn same(one: &Self::One) -> Self {
        one.as_ref().map(B::same)
    }

    fn put(&mut self, i: usize, one: &Self::One) {
        if let (Some(lanes), Some(one)) = (self, one) {
            lanes.put(i, one);
        }
    }

    fn scatter(&self, i: usize) -> Self::One {
        self.as_ref().map(|lanes| lanes.scatter(i))
    }

    #[inline(always)]
    fn choose(mask: R::Mask, yes: &Self, no: &Self) -> Self {
        match (yes, no) {
            (Some(yes), Some(no)) => Some(B::choose(mask, yes, no)),
            _ => None,
        }
    }
}

/// Declares a structure generic over the number type and implements [`Batch`] for it, field by field.
#[macro_export]
macro_rules! batch_struct {
    ($(#[$meta:meta])* $own:vis struct $name:ident<R> { $($(#[$field_meta:meta])* $vis:vis $field:ident: $type:ty,)* }) => {
        $(#[$meta])*
        #[derive(Clone, Copy, Debug, PartialEq)]
        $own struct $name<R> { $($(#[$field_meta])* $vis $field: $type,)* }

        impl<R: $crate::number::Real> $crate::batch::Batch<R> for $name<R> {
            type One = $name<f64>;

            fn same(one: &$name<f64>) -> Self {
                Self { $($field: <$type as $crate::batch::Batch<R>>::same(&one.$field),)* }
            }

            fn put(&mut self, i: usize, one: &$name<f64>) {
                $(<$type as $crate::batch::Batch<R>>::put(&mut self.$field, i, &one.$field);)*
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

/// Declares a choice between structures of lanes and implements [`Batch`] for it. All lanes choose alike.
///
/// # Panics
/// `put` and `choose`, if they do not.
#[macro_export]
macro_rules! batch_enum {
    ($(#[$meta:meta])* $own:vis enum $name:ident<R> { $($(#[$variant_meta:meta])* $variant:ident($type:ty),)* }) => {
        $(#[$meta])*
        #[derive(Clone, Copy, Debug, PartialEq)]
        $own enum $name<R> { $($(#[$variant_meta])* $variant($type),)* }

        impl<R: $crate::number::Real> $crate::batch::Batch<R> for $name<R> {
            type One = $name<f64>;

            fn same(one: &$name<f64>) -> Self {
                match one {
                    $($name::$variant(one) => Self::$variant($crate::batch::Batch::<R>::same(one)),)*
                }
            }

            fn put(&mut self, i: usize, one: &$name<f64>) {
                match (self, one) {
                    $(($name::$variant(lanes), $name::$variant(one)) => $crate::batch::Batch::<R>::put(lanes, i, one),)*
                    _ => $crate::batch::lanes_differ(),
                }
            }

            fn scatter(&self, i: usize) -> $name<f64> {
                match self {
                    $(Self::$variant(lanes) => $name::$variant($crate::batch::Batch::<R>::scatter(lanes, i)),)*
                }
            }

            #[inline(always)]
            fn choose(mask: R::Mask, yes: &Self, no: &Self) -> Self {
                match (yes, no) {
                    $((Self::$variant(yes), Self::$variant(no)) => {
                        Self::$variant($crate::batch::Batch::<R>::choose(mask, yes, no))
                    })*
                    _ => $crate::batch::lanes_differ(),
                }
            }
        }
    };
}

/// Implements [`Batch`] for a choice that is no number, and the same in all lanes.
///
/// # Panics
/// `put`, if a lane is given another one.
#[macro_export]
macro_rules! batch_uniform {
    ($($type:ty),*) => {$(
        impl<R: $crate::number::Real> $crate::batch::Batch<R> for $type {
            type One = $type;

            fn same(one: &$type) -> Self {
                *one
            }

            fn put(&mut self, _: usize, one: &$type) {
                if self != one {
                    $crate::batch::lanes_differ();
                }
            }

            fn scatter(&self, _: usize) -> $type {
                *self
            }

            #[inline(always)]
            fn choose(_: R::Mask, yes: &Self, _: &Self) -> Self {
                *yes
            }
        }
    )*};
}

batch_uniform!(());

/// Which law flies, and in which form, is a choice for a whole batch; anything else is a fault of the caller.
#[cold]
pub fn lanes_differ() -> ! {
    panic!("the flights of one batch must fly the same law in the same form")
}

/// Numbers that a campaign may change from flight to flight, found by their path: `chaser.mass`.
pub trait Fields {
    /// The numbers at a path; `None` where there are none.
    fn field(&mut self, path: &str) -> Option<&mut [f64]>;
}

impl Fields for f64 {
    fn field(&mut self, path: &str) -> Option<&mut [f64]> {
        path.is_empty().then_some(core::slice::from_mut(self))
    }
}

impl Fields for Vec3<f64> {
    fn field(&mut self, path: &str) -> Option<&mut [f64]> {
        path.is_empty().then_some(&mut self.0[..])
    }
}

impl Fields for Quat<f64> {
    fn field(&mut self, path: &str) -> Option<&mut [f64]> {
        path.is_empty().then_some(&mut self.0[..])
    }
}

impl Fields for Mat3<f64> {
    fn field(&mut self, path: &str) -> Option<&mut [f64]> {
        path.is_empty().then_some(self.0.as_flattened_mut())
    }
}

/// Implements [`Fields`] for a structure of numbers.
#[macro_export]
macro_rules! fields {
    ($type:ident $(<$number:ident>)?: $($field:ident),*) => {
        impl $crate::batch::Fields for $type $(<$number>)? {
            fn field(&mut self, path: &str) -> Option<&mut [f64]> {
                let (first, rest) = path.split_once('.').unwrap_or((path, ""));
                match first {
                    $(stringify!($field) => self.$field.field(rest),)*
                    _ => None,
                }
            }
        }
    };
}

/// A [`batch_struct!`] whose numbers are found by their paths.
#[macro_export]
macro_rules! case_struct {
    ($(#[$meta:meta])* pub struct $name:ident<R> { $($(#[$field_meta:meta])* pub $field:ident: $type:ty,)* }) => {
        $crate::batch_struct! { $(#[$meta])* pub struct $name<R> { $($(#[$field_meta])* pub $field: $type,)* } }
        $crate::fields!($name<f64>: $($field),*);
    };
}

#[cfg(test)]
mod tests;
