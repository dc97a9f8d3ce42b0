!> One key of a case file, as used by the documentation, the validation and the messages.
module rwmf_problem_key
   implicit none
   private

   public :: key_t, required, optional_key, of_kind, dimensional, with_si, usually, belongs_to
   public :: unless, fixed_by, takes_list
   public :: any_real, positive, below_one, not_negative

   character(*), parameter :: any_real = 'any finite number'
   character(*), parameter :: positive = '> 0'
   character(*), parameter :: below_one = '[0, 1)'
   character(*), parameter :: not_negative = '>= 0'

   !> One key. Texts are padded with blanks.
   type :: key_t
      character(12) :: group
      character(40) :: key
      !! in the spelling of the documentation; a case may use upper or lower case
      character(9) :: type
      !! 'real', 'real list', 'integer', 'logical', 'choice', 'text' or 'text list'
      character(6) :: unit
      !! unit of a number; '-' for a ratio, '' for texts and counts
      character(16) :: default
      !! default value, or the name of a key of the group that provides it; '' for none
      logical :: is_required
      !! required whenever the group is given
      character(104) :: allowed
      !! of a number: `> 0`, `>= 0` or an interval; of a choice: its names
      character(104) :: help
      character(88) :: kinds
      !! of `&motion`: the kinds that have the key; '' for all
      character(16) :: implies
      !! `KEY=VALUE`: value of a choice of the same group if this key is given and the choice is
      !! not; '' for nothing
      character(6) :: si = ''
      !! of a ratio to the mass or weight of the wall: unit after multiplication by the weight ('N')
      !! or the mass (others); '' for other keys
      character(40) :: gives = ''
      !! of a dimensional key: key of the group that is derived from it; '' for other keys
      character(64) :: needs = ''
      !! required other keys of the group, separated by blanks; one of several separated by '|' is
      !! enough
      logical :: scales = .false.
      !! may be given together with the key that it gives, and then scales its values
      character(16) :: usual = ''
      !! range of its magnitude in real buildings, '[low, high]'; values outside cause a warning
      character(20) :: unless = ''
      !! `group` or `group.key` beside which the key has no meaning; '' for none
      character(32) :: is_fixed_by = ''
      !! reason why a case that has been read cannot change the key; '' if it can
      character(24) :: former = ''
      !! of a choice: names that are still accepted
   end type key_t

contains

   !> Required key.
   pure type(key_t) function required(group, key, type, unit, allowed, help)
      character(*), intent(in) :: group
      !! name of the group, without &
      character(*), intent(in) :: key
      !! name of the key
      character(*), intent(in) :: type
      !! component of `key_t`, as the next ones
      character(*), intent(in) :: unit
      !! unit of a number; '-' for a ratio, '' for texts and counts
      character(*), intent(in) :: allowed
      !! range of a number, or names of a choice
      character(*), intent(in) :: help
      !! meaning of the key, for the user

      required = key_t(group, key, type, unit, '', .true., allowed, help, '', '')
   end function required

   !> Optional key.
   pure type(key_t) function optional_key(group, key, type, unit, default, allowed, help, implies)
      character(*), intent(in) :: group
      !! name of the group, without &
      character(*), intent(in) :: key
      !! name of the key
      character(*), intent(in) :: type
      !! component of `key_t`, as the next ones
      character(*), intent(in) :: unit
      !! unit of a number; '-' for a ratio, '' for texts and counts
      character(*), intent(in) :: default
      !! default value, or the key of the group that provides it; '' for none
      character(*), intent(in) :: allowed
      !! range of a number, or names of a choice
      character(*), intent(in) :: help
      !! meaning of the key, for the user
      character(*), intent(in), optional :: implies
      !! `KEY=VALUE`, value of a choice of the group if this key is given and the choice is not;
      !! absent for none

      optional_key = key_t(group, key, type, unit, default, .false., allowed, help, '', '')
      if (present(implies)) optional_key%implies = implies
   end function optional_key

   !> Key that is a ratio to the mass or to the weight of the wall.
   pure type(key_t) function with_si(si, ratio)
      character(*), intent(in) :: si
      !! component of `key_t`
      type(key_t), intent(in) :: ratio
      !! key without its unit

      with_si = ratio
      with_si%si = si
   end function with_si

   !> Key with the range of its magnitude in real buildings.
   pure type(key_t) function usually(range, key)
      character(*), intent(in) :: range
      !! component `usual` of `key_t`
      type(key_t), intent(in) :: key
      !! key without that range

      usually = key
      usually%usual = range
   end function usually

   !> Key without meaning beside another key or group.
   pure type(key_t) function unless(other, key)
      character(*), intent(in) :: other
      !! component `unless` of `key_t`
      type(key_t), intent(in) :: key
      !! key without that condition

      unless = key
      unless%unless = other
   end function unless

   !> Key that a case that has been read cannot change.
   pure type(key_t) function fixed_by(reason, key)
      character(*), intent(in) :: reason
      !! component `is_fixed_by` of `key_t`
      type(key_t), intent(in) :: key
      !! key without that reason

      fixed_by = key
      fixed_by%is_fixed_by = reason
   end function fixed_by

   !> Key in kg, N or Pa from which a ratio to the mass or weight of the wall is derived.
   pure type(key_t) function dimensional(group, key, type, unit, gives, needs, help, &
      allowed)
      character(*), intent(in) :: group
      !! name of the group, without &
      character(*), intent(in) :: key
      !! name of the key
      character(*), intent(in) :: type
      !! component of `key_t`, as the next ones
      character(*), intent(in) :: unit
      !! unit of the number
      character(*), intent(in) :: gives
      !! key of the group that is derived from it
      character(*), intent(in) :: needs
      !! required other keys of the group
      character(*), intent(in) :: help
      !! meaning of the key, for the user
      character(*), intent(in), optional :: allowed
      !! range of the number; absent: > 0

      dimensional = key_t(group, key, type, unit, '', .false., positive, help, '', '', '', gives, &
         needs)
      if (present(allowed)) dimensional%allowed = allowed
   end function dimensional

   !> Key that belongs to some kinds of motion.
   pure type(key_t) function of_kind(kinds, key, type, unit, default, allowed, help)
      character(*), intent(in) :: kinds
      !! names of the kinds of motion that have the key, separated by blanks; '' for all
      character(*), intent(in) :: key
      !! name of the key
      character(*), intent(in) :: type
      !! component of `key_t`, as the next ones
      character(*), intent(in) :: unit
      !! unit of a number; '-' for a ratio, '' for texts and counts
      character(*), intent(in) :: default
      !! default value, or the key of the group that provides it; '' for none
      character(*), intent(in) :: allowed
      !! range of a number, or names of a choice
      character(*), intent(in) :: help
      !! meaning of the key, for the user

      of_kind = key_t('motion', key, type, unit, default, .false., allowed, help, kinds, '')
   end function of_kind

   !> True if the key may have several values: a list, or 'reals' and 'integers', one number for all
   !> elements of the group or one for each.
   elemental logical function takes_list(key)
      type(key_t), intent(in) :: key

      takes_list = index(key%type, 'list') > 0 .or. any(key%type == ['reals   ', 'integers'])
   end function takes_list

   !> True if the key belongs to a kind of motion; always true in other groups.
   pure logical function belongs_to(key, kind)
      type(key_t), intent(in) :: key
      character(*), intent(in) :: kind
      !! name of a kind of motion, without blanks

      belongs_to = key%kinds == '' .or. index(' '//key%kinds//' ', ' '//kind//' ') > 0
   end function belongs_to

end module rwmf_problem_key
