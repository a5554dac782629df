//! splitsum measures how wrong the split-sum approximation of image-based lighting is.
//!
//! The modules follow the path of the data: environment, precompute, gbuffer, shade, tonemap, metrics, table.
//!
//! # Features
//!
//! Without features the crate computes on the CPU, in f64: [`environment`] loads a map, [`precompute`] prefilters it and makes tables,
//! [`shade::reference`] integrates a pixel, [`bakes`] writes and judges the tables of engines, [`oracle`] answers tables of queries.
//!
//! - `gpu` (default) renders on a Vulkan device: scenes, passes, the pipeline. It builds glslang, which is C++, and implies `exr`.
//! - `cli` (default) has experiments, runs, reports and the program `splitsum`. It implies `gpu`.
//! - `exr` reads and writes OpenEXR; without it Radiance, KTX, KTX 2, DDS and PNG remain.
//! - `view` has the window of `splitsum view`. It implies `cli`.
//!
//! # Bibliography
//!
//! Sources of formulas are cited by keys in square brackets:
//!
//! - Andersson20: P. Andersson, J. Nilsson, T. Akenine-Möller, M. Oskarsson, K. Åström and M. D. Fairchild, "FLIP: A Difference
//!   Evaluator for Alternating Images", Proc. ACM on Computer Graphics and Interactive Techniques 3(2), 2020.
//! - BT709: Recommendation ITU-R BT.709-6, "Parameter values for the HDTV standards for production and international programme
//!   exchange", 2015.
//! - Belcour18: L. Belcour, "Efficient Rendering of Layered Materials using an Atomic Decomposition with Statistical Operators", ACM
//!   Transactions on Graphics 37(4), 2018.
//! - Brewer03: C. A. Brewer, G. W. Hatchard and M. A. Harrower, "ColorBrewer in Print: A Catalog of Color Schemes for Maps",
//!   Cartography and Geographic Information Science 30(1), 2003.
//! - Burley12: B. Burley, "Physically-Based Shading at Disney", SIGGRAPH 2012 course notes.
//! - Burley20: B. Burley, "Practical Hash-based Owen Scrambling", Journal of Computer Graphics Techniques 9(4), 2020.
//! - Cigolle14: Z. H. Cigolle et al., "A Survey of Efficient Representations for Independent Unit Vectors", JCGT 3(2), 2014.
//! - Clarberg08: P. Clarberg and T. Akenine-Möller, "Practical Product Importance Sampling for Direct Illumination", Computer Graphics
//!   Forum 27(2), 2008.
//! - ClarbergSquare08: P. Clarberg, "Fast Equal-Area Mapping of the (Hemi)Sphere using SIMD", Journal of Graphics Tools 13 (3), 2008.
//! - Cocco24: G. Cocco, C. Zanni and X. Chermain, "Anisotropic Specular Image-Based Lighting Based on BRDF Major Axis Sampling",
//!   Computer Graphics Forum 43(7), 2024.
//! - Colbert07: M. Colbert and J. Křivánek, "GPU-Based Importance Sampling", GPU Gems 3, chapter 20, 2007.
//! - CranleyPatterson76: R. Cranley and T. N. L. Patterson, "Randomization of Number Theoretic Methods for Multiple Integration", SIAM
//!   Journal on Numerical Analysis 13(6), 1976.
//! - Duff17: T. Duff, J. Burgess, P. Christensen, C. Hery, A. Kensler, M. Liani and R. Villemin, "Building an Orthonormal Basis,
//!   Revisited", Journal of Computer Graphics Techniques 6(1), 2017.
//! - Dupuy23: J. Dupuy and A. Benyoub, "Sampling Visible GGX Normals with Spherical Caps", Computer Graphics Forum 42(8), 2023.
//! - Efron79: B. Efron, "Bootstrap Methods: Another Look at the Jackknife", The Annals of Statistics 7(1), 1979.
//! - EtoTokuyoshi23: K. Eto and Y. Tokuyoshi, "Bounded VNDF Sampling for Smith-GGX Reflections", SIGGRAPH Asia 2023 Technical
//!   Communications.
//! - FaigleKern92: U. Faigle and W. Kern, "The Shapley Value for Cooperative Games under Precedence Constraints", International Journal of
//!   Game Theory 21(3), 1992.
//! - FdezAguera19: C. J. Fdez-Agüera, "A Multiple-Scattering Microfacet Model for Real-Time Image-based Lighting", Journal of Computer
//!   Graphics Techniques 8(1), 2019.
//! - Giles12: M. Giles, "Approximating the erfinv Function", GPU Computing Gems Jade Edition, chapter 10, 2012.
//! - GlTF20: The Khronos Group, "glTF 2.0 Specification", version 2.0.1, 2021.
//! - Green07: P. Green, J. Kautz and F. Durand, "Efficient Reflectance and Visibility Approximations for Environment Map Rendering",
//!   Computer Graphics Forum 26(3), 2007.
//! - Heitz14: E. Heitz, "Understanding the Masking-Shadowing Function in Microfacet-Based BRDFs", Journal of Computer Graphics
//!   Techniques 3(2), 2014.
//! - Heitz18: E. Heitz, "Sampling the GGX Distribution of Visible Normals", Journal of Computer Graphics Techniques 7(4), 2018.
//! - HeitzDeon14: E. Heitz and E. d'Eon, "Importance Sampling Microfacet-Based BSDFs using the Distribution of Visible Normals",
//!   Computer Graphics Forum 33(4), 2014.
//! - HettmanspergerSheather86: T. P. Hettmansperger and S. J. Sheather, "Confidence Intervals Based on Interpolated Order Statistics",
//!   Statistics & Probability Letters 4(2), 1986.
//! - Hill18: S. Hill, "A Multi-Faceted Exploration (Part 3)", blog.selfshadow.com, 2018.
//! - HosekWilkie12: L. Hosek and A. Wilkie, "An Analytic Model for Full Spectral Sky-Dome Radiance", ACM Transactions on Graphics
//!   31(4), 2012.
//! - HyndmanFan96: R. J. Hyndman and Y. Fan, "Sample Quantiles in Statistical Packages", The American Statistician 50(4), 1996.
//! - Iglewicz93: B. Iglewicz and D. C. Hoaglin, "How to Detect and Handle Outliers", ASQC Quality Press, 1993.
//! - IwanickiPesce15: M. Iwanicki and A. Pesce, "Approximate Models for Physically Based Rendering", SIGGRAPH 2015 course notes.
//! - Jakob14: W. Jakob, "An Improved Visible Normal Sampling Routine for the Beckmann Distribution", technical report, ETH Zürich, 2014.
//! - Karis13: B. Karis, "Real Shading in Unreal Engine 4", SIGGRAPH 2013 course notes.
//! - Karlik19: O. Karlík, M. Šik, P. Vévoda, T. Skřivan and J. Křivánek, "MIS Compensation: Optimizing Sampling Techniques in Multiple
//!   Importance Sampling", ACM Transactions on Graphics 38(6), 2019.
//! - KastenYoung89: F. Kasten and A. T. Young, "Revised Optical Air Mass Tables and Approximation Formula", Applied Optics 28(22),
//!   1989.
//! - KautzMcCool00: J. Kautz and M. D. McCool, "Approximation of Glossy Reflection with Prefiltered Environment Maps", Graphics Interface
//!   2000.
//! - KhrTransform18: The Khronos Group, "KHR_texture_transform", extension of glTF 2.0, 2018.
//! - Kim22: M. Kim, "Project 3: Image-Based Lighting", report for the course CS562, 2022. This is "source document 0"; the words
//!   in quotation marks beside the key are its headings.
//! - Knuth97: D. E. Knuth, "The Art of Computer Programming", volume 2, 3rd edition, 1997.
//! - Kolmogorov50: A. N. Kolmogorov, "Unbiased Estimates", Izvestiya Akademii Nauk SSSR, Seriya Matematicheskaya 14, 1950.
//! - KullaConty17: C. Kulla and A. Conty, "Revisiting Physically Based Shading at Imageworks", SIGGRAPH 2017 course notes.
//! - Lagarde14: S. Lagarde and C. de Rousiers, "Moving Frostbite to Physically Based Rendering 3.0", SIGGRAPH 2014 course notes.
//! - Lam85: K. M. Lam, "Metamerism and Colour Constancy", doctoral thesis, University of Bradford, 1985.
//! - LlvmAmdgpu20: LLVM, scheduling model of the AMDGPU target (`SISchedule.td`), 2020.
//! - Malley88: T. J. V. Malley, "A Shading Method for Computer Generated Images", master's thesis, University of Utah, 1988.
//! - MansonSloan16: J. Manson and P.-P. Sloan, "Fast Filtering of Reflection Probes", Computer Graphics Forum 35(4), 2016.
//! - Mikkelsen08: M. S. Mikkelsen, "Simulation of Wrinkled Surfaces Revisited", master's thesis, University of Copenhagen, 2008.
//! - Owen97: A. B. Owen, "Monte Carlo Variance of Scrambled Net Quadrature", SIAM Journal on Numerical Analysis 34(5), 1997.
//! - PharrJakobHumphreys23: M. Pharr, W. Jakob and G. Humphreys, "Physically Based Rendering: From Theory to Implementation",
//!   4th edition, 2023.
//! - Preetham99: A. J. Preetham, P. Shirley and B. Smits, "A Practical Analytic Model for Daylight", SIGGRAPH 99.
//! - Ramamoorthi01: R. Ramamoorthi and P. Hanrahan, "An Efficient Representation for Irradiance Environment Maps", SIGGRAPH 2001.
//! - Roberts18: M. Roberts, "The Unreasonable Effectiveness of Quasirandom Sequences", extremelearning.com.au, 2018.
//! - Roughton24: T. Roughton, P.-P. Sloan, A. Silvennoinen, M. Iwanicki and P. Shirley, "ZH3: Quadratic Zonal Harmonics", Proc. ACM on
//!   Computer Graphics and Interactive Techniques 7(1), 2024.
//! - Rousselle11: F. Rousselle, C. Knaus and M. Zwicker, "Adaptive Sampling and Reconstruction using Greedy Error Minimization", ACM
//!   Transactions on Graphics 30(6), 2011.
//! - Schlick94: C. Schlick, "An Inexpensive BRDF Model for Physically-based Rendering", Computer Graphics Forum 13(3), 1994.
//! - Sen68: P. K. Sen, "Estimates of the Regression Coefficient Based on Kendall's Tau", Journal of the American Statistical Association
//!   63(324), 1968.
//! - Shapley53: L. S. Shapley, "A Value for n-Person Games", Contributions to the Theory of Games II, Princeton, 1953.
//! - Shoemake92: K. Shoemake, "Uniform Random Rotations", Graphics Gems III, 1992.
//! - Sidi93: A. Sidi, "A New Variable Transformation for Numerical Integration", Numerical Integration IV, 1993.
//! - Sloan08: P.-P. Sloan, "Stupid Spherical Harmonics (SH) Tricks", Game Developers Conference 2008.
//! - Sobol67: I. M. Sobol', "On the Distribution of Points in a Cube and the Approximate Evaluation of Integrals", USSR Computational
//!   Mathematics and Mathematical Physics 7(4), 1967.
//! - Srgb99: IEC 61966-2-1:1999, "Colour Measurement and Management, Part 2-1: Default RGB Colour Space, sRGB".
//! - Steele14: G. L. Steele, D. Lea and C. H. Flood, "Fast Splittable Pseudorandom Number Generators", OOPSLA 2014.
//! - Turquin19: E. Turquin, "Practical Multiple Scattering Compensation for Microfacet Models", technical report, Industrial Light & Magic,
//!   2019.
//! - VeachGuibas95: E. Veach and L. J. Guibas, "Optimally Combining Sampling Techniques for Monte Carlo Rendering", SIGGRAPH 95.
//! - Vegdahl21: N. Vegdahl, "Building a Better LK Hash", psychopath.io, 2021.
//! - Vulkan13: The Khronos Group, "Vulkan 1.3, A Specification", 2022.
//! - Walter07: B. Walter, S. R. Marschner, H. Li and K. E. Torrance, "Microfacet Models for Refraction through Rough Surfaces",
//!   Eurographics Symposium on Rendering 2007.
//! - Wang04: Z. Wang, A. C. Bovik, H. R. Sheikh and E. P. Simoncelli, "Image Quality Assessment: From Error Visibility to Structural
//!   Similarity", IEEE Transactions on Image Processing 13(4), 2004.
//! - Wang09: J. Wang, P. Ren, M. Gong, J. Snyder and B. Guo, "All-Frequency Rendering of Dynamic, Spatially-Varying Reflectance",
//!   ACM Transactions on Graphics 28(5), 2009.
//! - Ward94: G. J. Ward, "The RADIANCE Lighting Simulation and Rendering System", SIGGRAPH 94.
//! - Welford62: B. P. Welford, "Note on a Method for Calculating Corrected Sums of Squares and Products", Technometrics 4(3), 1962.
//! - Wellons18: C. Wellons, "Prospecting for Hash Functions", nullprogram.com, 2018.

pub mod glsl;

pub mod color;
pub mod files;
pub mod math;
pub mod pixels;
pub mod spelling;

pub mod brdf;
pub mod environment;
#[cfg(feature = "gpu")]
pub mod scene;

#[cfg(feature = "gpu")]
pub mod gpu;

#[cfg(feature = "gpu")]
pub mod gbuffer;
pub mod precompute;
pub mod shade;
pub mod tonemap;

#[cfg(feature = "cli")]
pub mod figure;
pub mod metrics;
pub mod table;

pub mod ladder;

pub mod bakes;
#[cfg(feature = "cli")]
pub mod cost;

pub mod oracle;
#[cfg(feature = "gpu")]
pub mod pipeline;

#[cfg(feature = "cli")]
pub mod experiment;
#[cfg(feature = "cli")]
pub mod run;

#[cfg(feature = "cli")]
pub mod study;

#[cfg(feature = "cli")]
pub mod report;
#[cfg(feature = "view")]
pub mod view;
