//! Model, view, projection, viewport: matrices that act on column vectors.
