//! Optimisers: plain control flow over an [`Oracle`](crate::search::Oracle).

mod catalogue;
mod cma_es;
mod de;
mod descent;
mod distribution;
mod hybrid;
mod l_bfgs_b;
mod l_shade;
mod method;
mod nelder_mead;
mod places;
mod population;
mod pso;
mod random;
mod scp;
mod slsqp;

pub use catalogue::{Hybrid, Setting, Settings};
pub use cma_es::CmaEs;
pub use de::De;
pub use l_bfgs_b::LBfgsB;
pub use l_shade::LShade;
pub use method::Optimiser;
pub use nelder_mead::NelderMead;
pub use pso::{Inertia, Pso, Walls};
pub use random::RandomSearch;
pub use scp::{Ending, Scp};
pub use slsqp::Slsqp;
