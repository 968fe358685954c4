//! How a picture for the screen shows light, in words and back.

use crate::color::{Look, Tone};

const EXPOSURE: &str = "exposure ";
const DITHERED: &str = "dithered";

/// As in `agx, exposure 1, dithered`; `None` for the usual way.
pub fn look_in_words(look: &Look) -> Option<String> {
    let usual = Look::default();
    let mut words = Vec::new();
    if look.tone != usual.tone {
        words.push(look.tone.name().to_owned());
    }
    if look.exposure != usual.exposure {
        words.push(format!("{EXPOSURE}{}", look.exposure));
    }
    if look.dither {
        words.push(DITHERED.to_owned());
    }
    (!words.is_empty()).then(|| words.join(", "))
}

/// What [`look_in_words`] means.
pub fn look_of_words(words: &str) -> Option<Look> {
    let mut look = Look::default();
    for word in words.split(", ") {
        if let Some(stops) = word.strip_prefix(EXPOSURE) {
            look.exposure = stops.parse().ok()?;
        } else if word == DITHERED {
            look.dither = true;
        } else {
            look.tone = Tone::NAMES.into_iter().find(|(name, _)| *name == word)?.1;
        }
    }
    Some(look)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_look_is_read_back_from_its_words() {
        let looks = [
            Look { tone: Tone::AgX, ..Look::default() },
            Look { exposure: -0.1, ..Look::default() },
            Look { exposure: 1e-7, tone: Tone::Filmic, dither: true },
        ];
        for look in looks {
            let words = look_in_words(&look).unwrap();
            assert_eq!(look_of_words(&words), Some(look), "{words}");
        }
        assert_eq!(look_in_words(&Look::default()), None);
        assert_eq!(look_of_words("sepia"), None);
    }
}
