//! Points and numbers between numpy and the library.

use driftless::search::{Bounds, Points};
use numpy::ndarray::Dimension;
use numpy::{
    PyArray, PyArray1, PyArray2, PyArrayDescrMethods, PyArrayMethods, PyReadonlyArray1,
    PyReadonlyArray2, PyUntypedArray, PyUntypedArrayMethods,
};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;

/// An array of doubles, one after the other in memory and aligned, of what is none yet.
fn as_doubles<'py>(x: &Bound<'py, PyAny>, what: &str) -> PyResult<Bound<'py, PyAny>> {
    static NUMPY: PyOnceLock<Py<PyAny>> = PyOnceLock::new();
    let py = x.py();
    let numpy =
        NUMPY.get_or_try_init(py, || Ok::<_, PyErr>(py.import("numpy")?.into_any().unbind()))?;
    let array = numpy.bind(py).call_method1("asarray", (x,))?;
    let dtype = array.cast::<PyUntypedArray>()?.dtype();
    if !b"fiub".contains(&dtype.kind()) {
        let message = format!("found {what} of dtype {dtype}, expected real numbers");
        return Err(PyTypeError::new_err(message));
    }
    numpy.bind(py).call_method1("require", (array, "float64", ("C", "A")))
}

/// Whether numbers lie where numbers of this kind may, as those of a field of a packed structure do not.
fn is_plain<D: Dimension>(array: &Bound<'_, PyArray<f64, D>>) -> bool {
    let size = size_of::<f64>().cast_signed();
    let is_aligned = array.data().is_aligned();
    is_aligned && array.strides().iter().all(|stride| stride % size == 0)
}

fn wrong_shape(what: &str, array: &Bound<'_, PyAny>, expected: &str) -> PyErr {
    match array.cast::<PyUntypedArray>() {
        Ok(array) => {
            let shape: Vec<String> = array.shape().iter().map(ToString::to_string).collect();
            let comma = if shape.len() == 1 { "," } else { "" };
            let shape = shape.join(", ");
            PyValueError::new_err(format!(
                "found {what} of shape ({shape}{comma}), expected {expected}"
            ))
        }
        Err(error) => error.into(),
    }
}

/// One point.
pub(crate) fn point(x: &Bound<'_, PyAny>, dimension: usize) -> PyResult<Vec<f64>> {
    let expected = format!("({dimension},)");
    let array = if let Some(array) = x.cast::<PyArray1<f64>>().ok().filter(|array| is_plain(array))
    {
        array.clone()
    } else {
        let array = as_doubles(x, "a point")?.cast_into::<PyArray1<f64>>();
        array.map_err(|error| wrong_shape("a point", &error.into_inner(), &expected))?
    };
    if array.len() != dimension {
        return Err(wrong_shape("a point", array.as_any(), &expected));
    }
    let array: PyReadonlyArray1<'_, f64> = array.try_readonly()?;
    Ok(array.as_array().to_vec())
}

/// Many points, one per row.
pub(crate) fn points(x: &Bound<'_, PyAny>, dimension: usize) -> PyResult<Points> {
    let expected = format!("(m, {dimension})");
    let array = if let Some(array) = x.cast::<PyArray2<f64>>().ok().filter(|array| is_plain(array))
    {
        array.clone()
    } else {
        let array = as_doubles(x, "points")?.cast_into::<PyArray2<f64>>();
        array.map_err(|error| wrong_shape("points", &error.into_inner(), &expected))?
    };
    if array.shape()[1] != dimension {
        return Err(wrong_shape("points", array.as_any(), &expected));
    }
    let array: PyReadonlyArray2<'_, f64> = array.try_readonly()?;
    let mut points = Points::zeros(dimension, array.shape()[0]);
    match array.as_slice().ok().filter(|_| array.is_c_contiguous()) {
        Some(all) => {
            let rows = all.chunks_exact(dimension);
            points.iter_mut().zip(rows).for_each(|(point, row)| point.copy_from_slice(row));
        }
        None => {
            for (point, row) in points.iter_mut().zip(array.as_array().outer_iter()) {
                point.iter_mut().zip(row).for_each(|(to, from)| *to = *from);
            }
        }
    }
    Ok(points)
}

/// Numbers as an array that the caller owns.
pub(crate) fn vector(py: Python<'_>, numbers: Vec<f64>) -> Bound<'_, PyArray1<f64>> {
    PyArray1::from_vec(py, numbers)
}

/// Rows of one length as an array.
pub(crate) fn matrix(
    py: Python<'_>,
    rows: usize,
    columns: usize,
    numbers: Vec<f64>,
) -> PyResult<Bound<'_, PyArray2<f64>>> {
    PyArray1::from_vec(py, numbers).reshape([rows, columns])
}

/// The lower or the upper bounds.
pub(crate) fn walls<'py>(
    py: Python<'py>,
    bounds: &Bounds,
    side: usize,
) -> Bound<'py, PyArray1<f64>> {
    vector(py, bounds.iter().map(|pair| pair[side]).collect())
}
