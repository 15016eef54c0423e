//! Punctual and area lights.
