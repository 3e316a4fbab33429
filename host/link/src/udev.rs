//! The udev rules by which Linux lets the user at the screen open a board, and the lines that install them.

/// The rules, as they are installed: Slipline's boards, the chip's bootloader, and the ST-LINKs with their serial ports.
pub const RULES: &str = include_str!("../70-slipline.rules");

/// The lines of a shell that install the rules where no package has; [`RULES`] has them as a comment.
pub fn install_lines() -> impl Iterator<Item = &'static str> {
    RULES.lines().filter_map(|line| line.strip_prefix("#   "))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_lines_install_the_rules() {
        let lines: Vec<_> = install_lines().collect();
        assert_eq!(lines.len(), 2, "{lines:?}");
        assert!(lines[0].starts_with("slipline udev | "), "{lines:?}");
        assert!(lines[1].contains("udevadm control --reload") && lines[1].contains("udevadm trigger"));
    }

    #[test]
    fn each_rule_is_for_one_product_and_for_the_user_at_the_screen() {
        let rules: Vec<_> = RULES.lines().filter(|line| !line.starts_with('#')).collect();
        let products = ["0001", "df11", "3748", "374b", "374e", "374f", "3752", "3753", "3754", "3757"];
        let of_product = |rule: &str| {
            let (_, rest) = rule.split_once("ATTRS{idProduct}==\"")?;
            rest.get(..4).map(str::to_owned)
        };
        let named: Vec<_> = rules.iter().filter_map(|rule| of_product(rule)).collect();
        assert_eq!(named, products);
        for rule in rules {
            assert!(rule.starts_with("ACTION!=\"remove\", SUBSYSTEMS==\"usb\", ATTRS{idVendor}=="), "{rule}");
            assert!(rule.contains("TAG+=\"uaccess\""), "{rule}");
        }
    }
}
