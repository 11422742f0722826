// XPBD.cpp needs nothing of it here.
