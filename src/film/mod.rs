//! How films are drawn and written: solids and lines in space → camera → facets → pictures → a file.
//!
//! A picture is drawn without any state of another, so pictures are drawn at the same time and the same scenes give the same bytes.

mod animated_png;
mod camera;
mod difference;
mod error;
mod facet;
mod ffmpeg;
mod format;
mod gif;
mod palette;
mod picture;
mod raster;
mod scene;
mod solid;
mod stills;
mod text;
mod write;

pub use camera::{Camera, View};
pub use error::FilmError;
pub use format::FilmFormat;
pub use picture::{Picture, Size};
pub use scene::{Label, Line, Scene};
pub use solid::{Form, Solid};
pub use write::{Film, write_film};
