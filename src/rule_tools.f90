!> What the rules between keys and groups have in common: conditions, and messages that name a group
!> or a key.
module rwmf_rule_tools
   use rwmf_errors, only: error_t
   use rwmf_given, only: entry_of, group_of, has_group, has_key
   use rwmf_namelist, only: group_t
   use rwmf_validation, only: fail_at_entry, fail_at_group
   implicit none
   private

   public :: check_needs, check_one_of, fail_group, fail_key

contains

   !> A group that is given needs another one.
   subroutine check_needs(groups, group, other, reason, error)
      type(group_t), intent(in) :: groups(:)
      character(*), intent(in) :: group
      character(*), intent(in) :: other
      character(*), intent(in) :: reason
      type(error_t), allocatable, intent(out) :: error

      if (.not. has_group(groups, group) .or. has_group(groups, other)) return
      call fail_group(groups, group, 'must not be given without &'//other//' ('//reason//')', error)
   end subroutine check_needs

   !> Exactly one of two keys must be given.
   subroutine check_one_of(groups, group, a, b, condition, error)
      type(group_t), intent(in) :: groups(:)
      character(*), intent(in) :: group
      character(*), intent(in) :: a
      character(*), intent(in) :: b
      character(*), intent(in) :: condition
      !! 'with ...'
      type(error_t), allocatable, intent(out) :: error

      if (has_key(groups, group, a) .and. has_key(groups, group, b)) then
         call fail_key(groups, group, b, 'must not be given beside '//a//': exactly one of both ' &
            //condition, error)
      else if (.not. has_key(groups, group, a) .and. .not. has_key(groups, group, b)) then
         call fail_group(groups, group, 'exactly one of the keys '//a//' and '//b &
            //' must be given '//condition, error)
      end if
   end subroutine check_one_of

   !> Report a group by its name.
   subroutine fail_group(groups, group, problem, error)
      type(group_t), intent(in) :: groups(:)
      character(*), intent(in) :: group
      character(*), intent(in) :: problem
      type(error_t), allocatable, intent(out) :: error

      call fail_at_group(groups(group_of(groups, group)), problem, error)
   end subroutine fail_group

   !> Report a key by its name.
   subroutine fail_key(groups, group, key, problem, error)
      type(group_t), intent(in) :: groups(:)
      character(*), intent(in) :: group
      character(*), intent(in) :: key
      character(*), intent(in) :: problem
      type(error_t), allocatable, intent(out) :: error
      integer :: at

      at = group_of(groups, group)
      call fail_at_entry(groups(at), groups(at)%entries(entry_of(groups(at), key)), problem, error)
   end subroutine fail_key

end module rwmf_rule_tools
