//! The tree model of Weber and Penn (SIGGRAPH 95), complete.
