//! What a fleet flies: one recipe, and the numbers in which its flights differ.

use detumble_core::case::FlightRecipe;
use detumble_core::scene::{Common, Laws, Numbers, PreparedFlight};

/// Numbers of each flight that stand in place of the recipe's, row by row.
#[derive(Clone, Debug)]
pub struct Column<'a> {
    /// Where they belong: `chaser.mass`, `start.position`, `law.before.rotation.gain`.
    pub path: String,
    /// Flights × numbers at the path.
    pub values: &'a [f64],
}

/// The flights of a fleet.
pub struct Fleet<'a> {
    recipe: FlightRecipe,
    columns: Vec<Column<'a>>,
    flights: usize,
    common: Common,
    /// The law that all flights share, if they do.
    laws: Option<Laws>,
}

impl<'a> Fleet<'a> {
    /// Flight i is `recipe` with row i of every column. Fails where a path leads nowhere or a column has another length.
    pub fn new(recipe: FlightRecipe, columns: Vec<Column<'a>>, flights: usize) -> Result<Self, String> {
        let common = Common::new(&recipe, columns.iter().map(|column| column.path.as_str()))
            .map_err(|path| format!("{path}: no number of a flight"))?;
        let mut sized = recipe.clone();
        for Column { path, values } in &columns {
            let width = sized.field(path).map_or(0, |numbers| numbers.len());
            if values.len() != flights * width {
                return Err(format!("{path}: {} numbers; needed: {flights} x {width}", values.len()));
            }
        }
        let laws = common.same_laws.then(|| Laws::new(&recipe.law, &recipe.case, &recipe.plan));
        Ok(Self { recipe, columns, flights, common, laws })
    }

    /// Number of flights.
    pub fn flights(&self) -> usize {
        self.flights
    }

    /// Clocks and switches, and all numbers that do not differ.
    pub fn recipe(&self) -> &FlightRecipe {
        &self.recipe
    }

    /// What is the same for all flights.
    pub fn common(&self) -> Common {
        self.common
    }

    /// Flight i, ready to be flown.
    pub fn prepared(&self, i: usize) -> PreparedFlight {
        let mut recipe = self.recipe.clone();
        for Column { path, values } in &self.columns {
            let numbers = recipe.field(path).expect("checked when the fleet was made");
            let width = numbers.len();
            numbers.copy_from_slice(&values[i * width..(i + 1) * width]);
        }
        match &self.laws {
            Some(laws) => PreparedFlight { numbers: Numbers::new(&recipe.case, &recipe.plan), laws: laws.clone() },
            None => PreparedFlight::new(&recipe),
        }
    }
}
