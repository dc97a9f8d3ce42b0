!> Rules between the groups that describe the frame: period, mass ratio, storeys.
module rwmf_input_rules_frame
   use rwmf_core_error, only: error_t
   use rwmf_core_kinds, only: wp
   use rwmf_input_group_values, only: get_list, has_group, has_key, real_of, text_of
   use rwmf_input_namelist, only: group_t
   use rwmf_input_rules_common, only: fail_group, fail_key, too_stiff
   use rwmf_text_strings, only: integer_to_text, real_to_text
   implicit none
   private

   public :: check_frame, check_storeys, check_hysteresis

contains

   !> Mass ratio and period of the frame.
   subroutine check_frame(groups, error)
      type(group_t), intent(in) :: groups(:)
      type(error_t), allocatable, intent(out) :: error

      if (.not. has_group(groups, 'frame') .or. has_group(groups, 'storeys')) return
      if (has_group(groups, 'wall') .and. .not. has_key(groups, 'frame', 'gamma')) then
         call fail_group(groups, 'frame', 'the key gamma is missing (mass ratio m_s/m_w): must ' &
            //'be given with &wall, a number >= 0 [-]', error)
      else if (has_key(groups, 'frame', 'gamma') .and. .not. has_group(groups, 'wall')) then
         call fail_key(groups, 'frame', 'gamma', 'must not be given without &wall (the bare ' &
            //'frame has no mass ratio)', error)
      else if (.not. has_key(groups, 'frame', 'T_s') .and. .not. has_group(groups, 'spectrum')) then
         call fail_group(groups, 'frame', 'the key T_s is missing (undamped period): must be ' &
            //'given without &spectrum, a number > 0 [s]', error)
      end if
   end subroutine check_frame

   !> Keys of the smooth law only with it. Smooth storeys one by one do not know which way they go
   !> from a start away from zero.
   subroutine check_hysteresis(groups, error)
      type(group_t), intent(in) :: groups(:)
      type(error_t), allocatable, intent(out) :: error
      character(8), parameter :: keys(2) = ['exponent', 'beta    ']
      integer :: i

      if (.not. has_group(groups, 'yielding')) return
      if (text_of(groups, 'yielding', 'law') == 'bouc_wen') then
         if (.not. has_group(groups, 'storeys')) return
         if (text_of(groups, 'storeys', 'coupling') /= 'full') return
         if (abs(real_of(groups, 'initial', 'theta_over_alpha')) <= 0) return
         call fail_key(groups, 'initial', 'theta_over_alpha', "must be 0 with &yielding law = " &
            //"'bouc_wen' and &storeys coupling = 'full', whose hysteresis begins at zero", error)
         return
      end if
      do i = 1, size(keys)
         if (.not. has_key(groups, 'yielding', trim(keys(i)))) cycle
         call fail_key(groups, 'yielding', trim(keys(i)), "belongs to law = 'bouc_wen'", error)
         return
      end do
   end subroutine check_hysteresis

   !> Storeys say what period and mass ratio would say; their lists belong together.
   subroutine check_storeys(groups, error)
      type(group_t), intent(in) :: groups(:)
      type(error_t), allocatable, intent(out) :: error
      real(wp), allocatable :: m(:)
      real(wp), allocatable :: k(:)
      real(wp), allocatable :: height(:)
      real(wp) :: top
      character(:), allocatable :: problem
      character(5), parameter :: keys(2) = ['T_s  ', 'gamma']
      integer :: i

      if (.not. has_group(groups, 'storeys')) return
      do i = 1, size(keys)
         if (.not. has_key(groups, 'frame', trim(keys(i)))) cycle
         call fail_key(groups, 'frame', trim(keys(i)), 'must not be given with &storeys, which ' &
            //'set it', error)
         return
      end do
      if (text_of(groups, 'storeys', 'coupling') == 'every_floor' &
          .and. .not. has_group(groups, 'wall')) then
         call fail_key(groups, 'storeys', 'coupling', "must not be 'every_floor' without &wall, " &
            //'which the floors are linked to', error)
         return
      end if
      if (has_key(groups, 'spectrum', 'gamma')) then
         call fail_key(groups, 'spectrum', 'gamma', 'must not be given with &storeys, which ' &
            //'set it', error)
         return
      end if
      call get_list(groups, 'storeys', 'm_over_m_w', m)
      call get_list(groups, 'storeys', 'k_over_m_w', k)
      call get_list(groups, 'storeys', 'height', height)
      if (size(k) /= size(m)) call fail_length('k_over_m_w', size(k))
      if (size(height) /= size(m)) call fail_length('height', size(height))
      if (allocated(error)) return
      problem = too_stiff(minval(sqrt(m/2)/sqrt(k/2 + [k(2:)/2, 0.0_wp])), 1.0_wp)
      if (len(problem) > 0) call fail_key(groups, 'storeys', 'k_over_m_w', 'between its storeys ' &
         //'a floor is too stiff: '//problem, error)
      if (allocated(error) .or. .not. has_group(groups, 'wall')) return
      top = 2*real_of(groups, 'wall', 'h')
      if (abs(sum(height) - top) <= 1.0e-6_wp*top) return
      call fail_key(groups, 'storeys', 'height', 'their sum is '//real_to_text(sum(height)) &
         //' m, must be the height of the wall that the roof is linked to, 2h = ' &
         //real_to_text(top)//' m', error)

   contains

      subroutine fail_length(key, n)
         character(*), intent(in) :: key
         integer, intent(in) :: n

         call fail_key(groups, 'storeys', key, 'has '//integer_to_text(n)//' values, must have ' &
            //'one for each of the '//integer_to_text(size(m))//' storeys of m_over_m_w', error)
      end subroutine fail_length
   end subroutine check_storeys

end module rwmf_input_rules_frame
