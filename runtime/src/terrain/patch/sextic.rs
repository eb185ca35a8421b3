//! The first root of a polynomial of degree 6: the height of a straight ray over a bicubic patch. It is isolated in halves by the signs
//! of Bernstein coefficients, of which a piece has as many changes as it has roots, or more by an even number (Descartes; Lane and
//! Riesenfeld 1981), then closed in on by Newton's method. Twin of `shaders/terrain/sextic.wgsl`.

/// Coefficients of 1, x, .. x^6 over [0, 1].
#[derive(Clone, Copy, Debug)]
pub(super) struct Sextic(pub [f32; 7]);

/// What a power's coefficient counts among Bernstein's: 1 / (6 over k).
const SHARES: [f32; 7] = [1.0, 1.0 / 6.0, 1.0 / 15.0, 1.0 / 20.0, 1.0 / 15.0, 1.0 / 6.0, 1.0];
/// Pieces this short are not cut further; grazing rays are decided by the piece's end.
const NARROW: f32 = 1e-5;
const PIECES: u32 = 96;
const STEPS: u32 = 32;

impl Sextic {
    /// Value and slope.
    fn at(&self, x: f32) -> [f32; 2] {
        let c = &self.0;
        (0..6).rev().fold([c[6], 0.0], |[value, slope], k| [value * x + c[k], slope * x + value])
    }

    /// Bernstein coefficients over [a, a + w].
    fn bernstein(&self, a: f32, w: f32) -> [f32; 7] {
        let mut c = self.0;
        for k in 0..6 {
            for j in (k..6).rev() {
                c[j] += a * c[j + 1];
            }
        }
        let mut power = 1.0;
        for (c, share) in c.iter_mut().zip(SHARES) {
            *c *= power * share;
            power *= w;
        }
        for k in 1..7 {
            for j in (k..7).rev() {
                c[j] += c[j - 1];
            }
        }
        c
    }

    /// First x in [0, 1] where the value is not above 0.
    pub fn first(&self) -> Option<f32> {
        let (mut a, mut w) = (0.0f32, 1.0f32);
        for _ in 0..PIECES {
            let b = self.bernstein(a, w);
            if b[0] <= 0.0 {
                return Some(a);
            }
            let above = b.map(|b| b > 0.0);
            let changes = above.windows(2).filter(|pair| pair[0] != pair[1]).count();
            let end = a + w;
            if changes == 1 {
                return Some(self.close_in(a, end, b[0] / (b[0] - b[6])));
            }
            if changes > 0 && w >= NARROW {
                w *= 0.5;
                continue;
            }
            if !above[6] {
                return Some(end);
            }
            if end >= 0.999999 {
                return None;
            }
            (a, w) = (end, (2.0 * w).min(1.0 - end));
        }
        None
    }

    /// The only root between `lo`, where the value is above 0, and `hi`, where it is not; it should be at a share of the way. It is not
    /// looked for at the end itself, where the value may be a rounding above 0 though the root is far before.
    fn close_in(&self, lo: f32, hi: f32, share: f32) -> f32 {
        let (mut lo, mut hi) = (lo, hi);
        let mut x = lo + share.min(0.9) * (hi - lo);
        for _ in 0..STEPS {
            let [value, slope] = self.at(x);
            if value > 0.0 {
                lo = x
            } else {
                hi = x
            }
            let step = x + value / (-slope).max(1e-30);
            let next = if slope < 0.0 && step >= lo && step <= hi { step } else { 0.5 * (lo + hi) };
            let far = (next - x).abs() > 1e-7;
            x = next;
            if !far {
                break;
            }
        }
        x
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn expand(roots: &[f64], lead: f64) -> [f64; 7] {
        let mut c = [0.0; 7];
        c[0] = lead;
        for (n, r) in roots.iter().enumerate() {
            for k in (0..=n + 1).rev() {
                c[k] = if k > 0 { c[k - 1] } else { 0.0 } - r * c[k];
            }
        }
        c
    }

    struct Random(u32);

    impl Random {
        fn unit(&mut self) -> f64 {
            self.0 = self.0.wrapping_mul(747796405).wrapping_add(2891336453);
            let word = ((self.0 >> ((self.0 >> 28) + 4)) ^ self.0).wrapping_mul(277803737);
            f64::from((word >> 22) ^ word) / 4294967296.0
        }
    }

    /// By stepping, in double precision, of the rounded coefficients.
    fn stepped(c: &[f32; 7], lift: f64) -> Option<f64> {
        const STEPS: u32 = 20_000;
        let value = |x: f64| c.iter().rev().fold(0.0, |sum, c| sum * x + f64::from(*c)) + lift;
        (0..=STEPS).map(|i| f64::from(i) / f64::from(STEPS)).find(|x| value(*x) <= 0.0)
    }

    #[test]
    fn the_first_root_is_found_and_no_other() {
        let mut random = Random(3);
        let (mut met, mut missed) = (0, 0);
        for _ in 0..2_000 {
            // Real roots in and around the interval, some close together; pairs of complex ones near it.
            let real: Vec<f64> = (0..6).map(|_| 3.0 * random.unit() - 1.0).collect();
            let close = [real[0], real[0] + 1e-2 * random.unit(), real[2], real[3], real[4], real[5]];
            let chosen = if random.unit() < 0.5 { &real[..] } else { &close[..] };
            let mut c = expand(chosen, 1.0).map(|x| x as f32);
            if random.unit() < 0.3 {
                c[0] += random.unit() as f32;
            }
            if c[0] <= 0.0 {
                c = c.map(|x| -x);
            }
            let size = c.iter().fold(0.0f32, |most, x| most.max(x.abs()));
            let slack = f64::from(4e-6 * size);
            let (early, late) = (stepped(&c, -slack), stepped(&c, slack));
            match Sextic(c).first().map(f64::from) {
                Some(x) => {
                    met += 1;
                    assert!(early.is_some_and(|e| x >= e - 1e-4), "{c:?}: {x}, not before {early:?}");
                    assert!(late.is_none_or(|l| x <= l + 1e-4), "{c:?}: {x}, not behind {late:?}");
                }
                None => {
                    missed += 1;
                    assert!(late.is_none(), "{c:?}: missed {late:?}");
                }
            }
        }
        assert!(met > 500 && missed > 200, "{met} met, {missed} missed");
    }

    /// A root that Newton's method comes near by halves of its interval only.
    #[test]
    fn roots_are_closed_in_on() {
        let mut random = Random(5);
        let mut slow = 0;
        for _ in 0..20_000 {
            let roots: Vec<f64> =
                (0..6).map(|k| if k == 0 { random.unit() } else { 4.0 * random.unit() - 1.5 }).collect();
            let c = expand(&roots, 1.0).map(|x| x as f32);
            let c = if c[0] <= 0.0 { c.map(|x| -x) } else { c };
            let Some(x) = Sextic(c).first() else { continue };
            let [value, slope] = Sextic(c).at(x);
            let size: f32 = c.iter().map(|c| c.abs()).sum();
            slow += u32::from(value.abs() > 2e-6 * size && value.abs() > 1e-4 * slope.abs() && x > 0.0);
        }
        assert_eq!(slow, 0);
    }

    #[test]
    fn ends_and_touching_roots() {
        let first = |c: [f32; 7]| Sextic(c).first();
        assert_eq!(first([0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0]), Some(0.0));
        assert_eq!(first([-1.0, 9.0, 0.0, 0.0, 0.0, 0.0, 0.0]), Some(0.0));
        assert_eq!(first([1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]), None);
        assert!((first([1.0, -1.0, 0.0, 0.0, 0.0, 0.0, 0.0]).unwrap() - 1.0).abs() < 1e-6);
        // A first root that lies where the highest coefficients come down, not where a line from the first would.
        let steep =
            first([1.8264838, -10.731802, 28.83453, -37.00287, 2.7497294, 23.081907, -8.590123]).unwrap();
        assert!((steep - 0.42175).abs() < 1e-4, "{steep}");
        // A dip that ends where the interval does, by rounding above 0.
        let dip = first([7.161173, -10.20352, -19.796051, 22.8384, 0.0, 0.0, 0.0]).unwrap();
        assert!((dip - 0.4973).abs() < 1e-3, "{dip}");
        // (x - 1/2)^2, a little above and a little below.
        assert_eq!(first([0.2501, -1.0, 1.0, 0.0, 0.0, 0.0, 0.0]), None);
        let below = first([0.2499, -1.0, 1.0, 0.0, 0.0, 0.0, 0.0]).unwrap();
        assert!((below - 0.49).abs() < 1e-4, "{below}");
    }
}
