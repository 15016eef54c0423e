//! Error metrics and filters of pictures.
