!> Cases of a member: every effect, and walls with all of them.
module member_cases
   use rwmf_core_kinds, only: wp
   implicit none
   private

   public :: member_case, member_case_count, member_case_name, leaning

   character(*), parameter :: nl = new_line('a')
   character(*), parameter :: storeys = '&storeys m_over_m_w = 2.5, 2.0, k_over_m_w = 800.0, ' &
      //'600.0, height = 2.0, 2.0, coupling = '
   character(*), parameter :: bends = '&bending EI_over_m_w = 5000.0, modes = '
   character(*), parameter :: devices = '&damper c_over_m_w = 0.5 /'//nl &
      //'&inerter inertance_over_m_w = 1.0 /'//nl//'&vertical ratio = 0.5 /'//nl
   character(*), parameter :: one_mass = '&frame T_s = 0.5, gamma = 5.0, xi_s = 0.05 /'//nl
   character(*), parameter :: many = '&frame xi_s = 0.05 /'//nl
   character(*), parameter :: leaning = '&initial theta_over_alpha = 0.1 /'
   character(*), parameter :: yields = '&cable eta_0 = 1.0, eta_alpha = 5.0, eta_y = 1.2, ' &
      //'hardening = 0.02 /'//nl

   character(40), parameter :: names(26) = [character(40) :: 'plain', 'published', 'symmetric', &
      'link', 'truss', 'devices', 'nl_damper', 'fuse', 'friction', 'flag', 'tendon yields', &
      'tendon goes slack', 'tendon breaks', 'hinged', 'hinged with fuses', 'yielding frame', &
      'p_delta', 'reduced', 'every_floor', 'full', 'springs', 'bending', &
      'bending, every_floor', 'bending, springs', 'all, rigid', 'all, bending']
   integer, parameter :: member_case_count = size(names)

contains

   !> Name of a case.
   pure function member_case_name(i) result(name)
      integer, intent(in) :: i
      !! number of the case
      character(:), allocatable :: name

      name = trim(names(i))
   end function member_case_name

   !> Namelist text of a case; `more` has further groups.
   pure function member_case(i, more) result(text)
      integer, intent(in) :: i
      !! number of the case
      character(*), intent(in) :: more
      character(:), allocatable :: text

      text = groups_of(trim(names(i)))//"&motion kind = 'one_sine', a_max_g = 0.7, " &
         //'omega_p = 8.0 /'//nl//more//nl//"&solver method = 'dop853', rtol = 1e-10, " &
         //'t_end = 2.0 /'//nl
   end function member_case

   !> Wall, frame and effects of a case.
   pure function groups_of(name) result(text)
      character(*), intent(in) :: name
      character(:), allocatable :: text
      character(:), allocatable :: wall, frame, model

      wall = '&wall h = 2.0, b = 0.5, m_w = 2.0e4 /'//nl
      frame = one_mass
      model = "&model formulation = 'exact' /"//nl
      text = "&impact rule = 'coupled' /"//nl
      select case (name)
      case ('published', 'symmetric')
         model = "&model formulation = '"//name//"' /"//nl
         text = "&impact rule = 'constant', e = 0.9 /"//nl &
            //'&cable eta_0 = 1.0, eta_alpha = 5.0 /'//nl
      case ('link')
         text = text//'&link L = 6.0 /'//nl
      case ('truss')
         text = text//"&cable eta_0 = 1.0, eta_alpha = 5.0, law = 'truss' /"//nl
      case ('devices')
         text = text//devices
      case ('nl_damper')
         text = text//'&nl_damper eta_1 = 0.1, exponent = 0.4 /'//nl
      case ('fuse')
         text = text//'&fuse eta_y = 0.3, stroke_y = 0.01, hardening = 0.02 /'//nl
      case ('friction')
         text = text//"&fuse eta_y = 0.3, stroke_y = 0.01, law = 'friction', breakaway = 1.2 /"//nl
      case ('flag')
         text = text//"&fuse eta_y = 0.3, stroke_y = 0.01, law = 'flag', flag_height = 0.9 /"//nl
      case ('tendon yields')
         text = text//yields
      case ('tendon goes slack')
         text = text//'&cable eta_0 = 0.1, eta_alpha = 5.0, eta_y = 0.3 /'//nl
      case ('tendon breaks')
         text = text//'&cable eta_0 = 1.0, eta_alpha = 5.0, rupture_strain = 0.01 /'//nl
      case ('hinged', 'hinged with fuses')
         wall = "&wall h = 2.0, b = 0.5, m_w = 2.0e4, base = 'pinned' /"//nl
         text = '&damper c_over_m_w = 0.5 /'//nl
         if (name == 'hinged with fuses') text = '&fuse eta_y = 0.3, stroke_y = 0.01 /'//nl
      case ('yielding frame')
         text = text//"&yielding u_y = 0.01, law = 'elastic_plastic' /"//nl
      case ('p_delta')
         text = text//'&p_delta /'//nl
      case ('reduced', 'every_floor', 'full', 'springs')
         frame = many
         text = text//storeys//"'"//name//"'"//links(name)//' /'//nl
      case ('bending')
         text = text//bends//'2, xi = 0.1 /'//nl
      case ('bending, every_floor', 'bending, springs')
         frame = many
         text = text//bends//'3 /'//nl//storeys//"'"//name(10:)//"'"//links(name(10:))//' /'//nl
      case ('all, rigid', 'all, bending')
         frame = many
         text = text//yields//devices//'&fuse eta_y = 0.3, stroke_y = 0.01 /'//nl &
            //storeys//"'springs'"//links('springs')//' /'//nl
         if (name == 'all, bending') text = text//bends//'2 /'//nl
      case default
         ! the plain wall
      end select
      text = wall//frame//text//model
   end function groups_of

   !> Link springs, where a coupling has them.
   pure function links(coupling) result(text)
      character(*), intent(in) :: coupling
      character(:), allocatable :: text

      text = ''
      if (coupling == 'springs') text = ', k_link_over_m_w = 4e3, 6e3'
   end function links

end module member_cases
